#include "kernels/solver/rigid_bodies.hpp"

#include <Eigen/LU>
#include <stdexcept>

#include "kernels/mesh/node_sums.hpp"

namespace cgcontact {
namespace {

using Flags = Kokkos::View<char*, MemSpace>;

Flags free_nodes(const BodyMesh& mesh) {
  const Flags flags("cgcontact::rigid_bodies::is_free", mesh.num_nodes);
  const auto host = Kokkos::create_mirror_view(flags);
  for (int n = 0; n < mesh.num_nodes; ++n) host(n) = mesh.is_free(n) ? 1 : 0;
  Kokkos::deep_copy(flags, host);
  return flags;
}

/// The values of a body's nodes, or of its constrained ones, become zero.
void set_to_zero(const ExecSpace& exec, const BodyMesh& mesh, const Flags& is_free, bool only_constrained,
                 const RealView& v) {
  const std::size_t first = dof_offset(mesh.first_node);
  Kokkos::parallel_for(
      "cgcontact::rigid_bodies::zero", Kokkos::RangePolicy<ExecSpace>(exec, 0, mesh.num_nodes),
      KOKKOS_LAMBDA(const int n) {
        if (only_constrained && is_free(n)) return;
        for (int i = 0; i < dofs_per_node; ++i) v(first + dof_offset(n, i)) = 0;
      });
}

}  // namespace

RigidBodies::RigidBodies(const ExecSpace& exec, const ElasticSystem& system) : exec_(exec) {
  for (const BodyMesh& mesh : system.meshes) {
    if (!mesh.rigid) continue;
    Body body{&mesh, centre_of_nodes(mesh), Eigen::Matrix<double, 6, 6>::Zero(), free_nodes(mesh)};
    const int axis = mesh.cut_cells->grid.plane_strain;
    std::vector<int> moves;
    for (int k = 0; k < 6; ++k)
      if (mesh.moves(k)) moves.push_back(k);
    const auto count = static_cast<Eigen::Index>(moves.size());
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);  // of the motions, over the free nodes
    for (int n = 0; n < mesh.num_nodes; ++n) {
      if (!mesh.is_free(n)) continue;
      const Vec3 arm = mesh.node_position(n) - body.centre;
      Eigen::Matrix<double, 3, 6> all;
      for (int k = 0; k < 3; ++k) {
        all.col(k) = Vec3::Unit(k);
        all.col(3 + k) = Vec3::Unit(k).cross(arm);
      }
      Eigen::MatrixXd motions(3, count);
      for (Eigen::Index i = 0; i < count; ++i) motions.col(i) = all.col(moves[i]);
      if (axis >= 0) motions.row(axis).setZero();
      products += motions.transpose() * motions;
    }
    const Eigen::MatrixXd inverse = products.inverse();
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j < count; ++j) body.motion_of_sums(moves[i], moves[j]) = inverse(i, j);
    bodies_.push_back(body);
  }
}

void RigidBodies::project(NodeValues kind, const RealView& v) const {
  for (const Body& body : bodies_) project(body, kind, v);
}

void RigidBodies::project(const Body& body, NodeValues kind, const RealView& v) const {
  const BodyMesh& mesh = *body.mesh;
  set_to_zero(exec_, mesh, body.is_free, true, v);
  const NodeSums sums = sums_of_nodes(exec_, mesh, body.centre, v);
  set_to_zero(exec_, mesh, body.is_free, false, v);
  Eigen::Matrix<double, 6, 1> all;
  all << sums.sum, sums.moment;
  const Eigen::Matrix<double, 6, 1> motion = body.motion_of_sums * all;
  add_rigid_motion(exec_, mesh, body.centre, motion.head<3>(), motion.tail<3>(), v);
  if (kind == NodeValues::forces) set_to_zero(exec_, mesh, body.is_free, true, v);
}

void OnRigidMotions::apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha,
                           double beta) const {
  if (alpha != 1 || beta != 0) throw std::logic_error("OnRigidMotions: alpha = 1, beta = 0 only");
  inner_->apply(X, Y, mode, alpha, beta);
  Kokkos::fence();
  const auto y = Y.getLocalViewDevice(Tpetra::Access::ReadWrite);
  bodies_.project(result_, RealView(y.data(), Y.getLocalLength()));
}

}  // namespace cgcontact
