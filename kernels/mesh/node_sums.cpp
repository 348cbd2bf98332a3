#include "kernels/mesh/node_sums.hpp"

namespace cgcontact {
namespace {

/// Nodes that one thread sums, in turn.
constexpr int nodes_per_thread = 4096;

/// Positions of the nodes where kernels read them: the host's, where they reach it.
struct NodePositions {
  Kokkos::View<const Index3*, MemSpace> position;
  Kokkos::View<const signed char*, MemSpace> level;  ///< empty: 0
  double centre[3];

  NodePositions(const BodyMesh& mesh, const Vec3& about)
      : position(copied(mesh.nodes)), level(copied(mesh.node_levels)), centre{about[0], about[1], about[2]} {}
  KOKKOS_INLINE_FUNCTION Vec3 arm(int node) const {
    const double size = level.extent(0) == 0 ? 1 : 1.0 / (1 << level(node));
    const int* at = position(node).data();
    return {size * at[0] - centre[0], size * at[1] - centre[1], size * at[2] - centre[2]};
  }

 private:
  template <class T>
  static Kokkos::View<const T*, MemSpace> copied(const std::vector<T>& values) {
    using Host = Kokkos::View<const T*, Kokkos::HostSpace>;
    return Kokkos::create_mirror_view_and_copy(MemSpace(), Host(values.data(), values.size()));
  }
};

}  // namespace

Vec3 centre_of_nodes(const BodyMesh& mesh) {
  Vec3 centre = Vec3::Zero();
  for (int n = 0; n < mesh.num_nodes; ++n) centre += mesh.node_position(n);
  return centre / mesh.num_nodes;
}

NodeSums sums_of_nodes(const ExecSpace& exec, const BodyMesh& mesh, const Vec3& centre,
                       const Kokkos::View<const double*, MemSpace>& u) {
  const int num_nodes = mesh.num_nodes, num_blocks = (num_nodes + nodes_per_thread - 1) / nodes_per_thread;
  const std::size_t first = dof_offset(mesh.first_node);
  const NodePositions positions(mesh, centre);
  const Kokkos::View<NodeSums*, MemSpace> partials("cgcontact::node_sums::parts", num_blocks);
  Kokkos::parallel_for(
      "cgcontact::node_sums::sum", Kokkos::RangePolicy<ExecSpace>(exec, 0, num_blocks), KOKKOS_LAMBDA(const int b) {
        NodeSums partial;
        for (int n = b * nodes_per_thread; n < num_nodes && n < (b + 1) * nodes_per_thread; ++n) {
          const std::size_t dof = first + dof_offset(n);
          const Vec3 v(u(dof), u(dof + 1), u(dof + 2));
          partial.sum += v;
          partial.moment += positions.arm(n).cross(v);
        }
        partials(b) = partial;
      });
  exec.fence();
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), partials);
  NodeSums all;
  for (int b = 0; b < num_blocks; ++b) {
    all.sum += host(b).sum;
    all.moment += host(b).moment;
  }
  return all;
}

void add_rigid_motion(const ExecSpace& exec, const BodyMesh& mesh, const Vec3& centre, const Vec3& translation,
                      const Vec3& rotation, const RealView& u) {
  const NodePositions positions(mesh, centre);
  const std::size_t first = dof_offset(mesh.first_node);
  Kokkos::parallel_for(
      "cgcontact::node_sums::add", Kokkos::RangePolicy<ExecSpace>(exec, 0, mesh.num_nodes), KOKKOS_LAMBDA(const int n) {
        const Vec3 moved = translation + rotation.cross(positions.arm(n));
        for (int i = 0; i < dofs_per_node; ++i) u(first + dof_offset(n, i)) += moved[i];
      });
}

}  // namespace cgcontact
