#include "kernels/mesh/node_sums.hpp"

#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

/// Nodes per chunk of the parallel loops.
constexpr std::size_t grain = 4096;

Vec3 arm(const BodyMesh& mesh, const Vec3& centre, std::size_t node) {
  return mesh.node_position(static_cast<int>(node)) - centre;
}

}  // namespace

Vec3 centre_of_nodes(const BodyMesh& mesh) {
  Vec3 centre = Vec3::Zero();
  for (int n = 0; n < mesh.num_nodes; ++n) centre += mesh.node_position(n);
  return centre / mesh.num_nodes;
}

NodeSums sums_of_nodes(const BodyMesh& mesh, const Vec3& centre, const RealView& u) {
  std::vector<NodeSums> parts(num_chunks(mesh.nodes.size(), grain));
  parallel_chunks("cgcontact::node_sums::sum", mesh.nodes.size(), grain,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    NodeSums part;
                    for (std::size_t n = begin; n < end; ++n) {
                      const std::size_t first = dof_offset(mesh.first_node + n);
                      const Vec3 v(u(first), u(first + 1), u(first + 2));
                      part.sum += v;
                      part.moment += arm(mesh, centre, n).cross(v);
                    }
                    parts[chunk] = part;
                  });
  NodeSums all;
  for (const NodeSums& part : parts) {
    all.sum += part.sum;
    all.moment += part.moment;
  }
  return all;
}

void add_rigid_motion(const BodyMesh& mesh, const Vec3& centre, const Vec3& translation, const Vec3& rotation,
                      const RealView& u) {
  parallel_for("cgcontact::node_sums::add", mesh.nodes.size(), grain, [&](std::size_t n) {
    const Vec3 moved = translation + rotation.cross(arm(mesh, centre, n));
    for (int i = 0; i < 3; ++i) u(dof_offset(mesh.first_node + n, i)) += moved[i];
  });
}

}  // namespace cgcontact
