#include "kernels/mesh/grid_numbers.hpp"

namespace cgcontact {

std::vector<int> numbers_on_grid(const BodyMesh& mesh) {
  const Grid& grid = mesh.cut_cells->grid;
  std::vector<int> number(grid.node_index(grid.num_cells) + 1, -1);
  for (int n = 0; n < mesh.num_nodes; ++n) number[grid.node_index(mesh.nodes[n])] = mesh.first_node + n;
  return number;
}

}  // namespace cgcontact
