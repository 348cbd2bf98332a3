#include "contact/solve/floating/body_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "kernels/mesh/node_sums.hpp"

namespace cgcontact {
namespace {

Vec3 grid_position(const BodyMesh& mesh, std::size_t node) { return mesh.node_position(static_cast<int>(node)); }

}  // namespace

BodyMotions::BodyMotions(const std::vector<BodyMesh>& meshes, const Scales& scales)
    : meshes_(meshes), length_(scales.length), motions_(meshes.size()) {
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    const BodyMesh& mesh = meshes[b];
    Vec3 centre = centre_of_nodes(mesh);
    if (const Grid& grid = mesh.cut_cells->grid; grid.is_axisymmetric())  // nothing on the axis moves away from it
      centre[grid.radial_axis()] = -grid.origin[grid.radial_axis()] / grid.cell_size;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec3 d = grid_position(mesh, n) - centre;
      inertia += d.squaredNorm() * Mat3::Identity() - d * d.transpose();
    }
    centre_.push_back(centre);
    inertia_.push_back(inertia);
    motions_[b].centre = mesh.cut_cells->grid.to_global(centre);
  }
}

void BodyMotions::forget() {
  for (BodyMotion& motion : motions_) motion.translation = motion.rotation = Vec3::Zero();
}

Kokkos::View<const BodyMotion*, MemSpace> BodyMotions::on_device() const {
  const Kokkos::View<const BodyMotion*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(motions_.data(),
                                                                                         motions_.size());
  const Kokkos::View<BodyMotion*, MemSpace> motions("cgcontact::body_motion::parts", motions_.size());
  Kokkos::deep_copy(motions, host);
  return motions;
}

void BodyMotions::set_aside(const ExecSpace& exec, const RealView& u) {
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    const BodyMesh& mesh = meshes_[b];
    const Grid& grid = mesh.cut_cells->grid;
    const NodeSums found = sums_of_nodes(exec, mesh, centre_[b], u);
    Vec3 translation = found.sum / static_cast<double>(mesh.nodes.size());
    Vec3 rotation = inertia_[b].llt().solve(found.moment);
    for (int i = 0; i < 3; ++i) {  // those of plane strain are zero but for rounding
      if (!mesh.moves(i)) translation[i] = 0;
      if (!mesh.moves(3 + i)) rotation[i] = 0;
    }
    if (mesh.rigid)  // nothing is left
      Kokkos::deep_copy(
          exec,
          Kokkos::subview(u, std::pair(dof_offset(mesh.first_node), dof_offset(mesh.first_node + mesh.num_nodes))),
          0.0);
    else
      add_rigid_motion(exec, mesh, centre_[b], -translation, -rotation, u);
    motions_[b].translation += length_ * (grid.rotation * translation);
    motions_[b].rotation += length_ / grid.cell_size * (grid.rotation * rotation);
  }
}

void BodyMotions::move(std::size_t body, const Vec3& translation, const Vec3& rotation, const Vec3& centre) {
  BodyMotion& motion = motions_[body];
  motion.translation += translation + rotation.cross(motion.centre - centre);
  motion.rotation += rotation;
}

double BodyMotions::largest_displacement(const ExecSpace& exec, const RealView& u) const {
  double largest = 0;
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    const BodyMesh& mesh = meshes_[b];
    double deformation = 0;
    Kokkos::parallel_reduce(
        "cgcontact::body_motion::largest",
        Kokkos::RangePolicy<ExecSpace>(exec, dof_of(mesh.first_node), dof_of(mesh.first_node + mesh.num_nodes)),
        KOKKOS_LAMBDA(const int i, double& most) {
          const double size = u(i) < 0 ? -u(i) : u(i);
          most = size > most ? size : most;
        },
        Kokkos::Max<double>(deformation));
    const Index3& cells = mesh.cut_cells->grid.num_cells;
    const double size = mesh.cut_cells->grid.cell_size * *std::max_element(cells.begin(), cells.end());
    const double rigid =
        motions_[b].translation.norm() + size * (motions_[b].rotation.norm() + motions_[b].expansion.norm());
    largest = std::max(largest, deformation + rigid / length_);
  }
  return largest;
}

}  // namespace cgcontact
