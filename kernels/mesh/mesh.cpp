#include "kernels/mesh/mesh.hpp"

#include <algorithm>

namespace cgcontact {
namespace {

/// Numbers the corners of active cells in grid order.
void number_nodes(BodyMesh& mesh) {
  const CutCells& cc = *mesh.cut_cells;
  const Grid& grid = cc.grid;
  const auto total =
      static_cast<std::size_t>(grid.num_cells[0] + 1) * (grid.num_cells[1] + 1) * (grid.num_cells[2] + 1);
  std::vector<int> number(total, -1);
  for (const Index3& c : cc.cells)
    for (int a = 0; a < 8; ++a) number[grid.node_index({c[0] + (a & 1), c[1] + (a >> 1 & 1), c[2] + (a >> 2)})] = 0;
  mesh.nodes.reserve(number.size() - std::count(number.begin(), number.end(), -1));
  int next = 0;
  for (int k = 0; k <= grid.num_cells[2]; ++k)
    for (int j = 0; j <= grid.num_cells[1]; ++j)
      for (int i = 0; i <= grid.num_cells[0]; ++i) {
        int& n = number[grid.node_index({i, j, k})];
        if (n < 0) continue;
        n = next++;
        mesh.nodes.push_back({i, j, k});
      }
  mesh.num_nodes = next;
  mesh.cell_nodes.resize(cc.cells.size());
  for (std::size_t e = 0; e < cc.cells.size(); ++e) {
    const Index3& c = cc.cells[e];
    for (int a = 0; a < 8; ++a) {
      const int n = number[grid.node_index({c[0] + (a & 1), c[1] + (a >> 1 & 1), c[2] + (a >> 2)})];
      mesh.cell_nodes[e][a] = mesh.first_node + n;
    }
  }
}

}  // namespace

bool is_ghost_face(const BodyMesh& mesh, int e, int f) {
  constexpr double well_filled = 0.25;
  const auto badly = [&](int cell) {
    const double full = mesh.full_volume.empty() ? 1.0 : mesh.full_volume[cell];
    return mesh.cut_cells->volume_fraction(cell) < well_filled * full;
  };
  return badly(e) || badly(f);
}

BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node) {
  BodyMesh mesh;
  mesh.cut_cells = &cut_cells;
  mesh.law = UnitElasticity(material.poisson_ratio);
  mesh.modulus = material.youngs_modulus / scales.stress;
  mesh.cell_size = cut_cells.grid.cell_size / scales.length;
  mesh.first_node = first_node;
  number_nodes(mesh);
  return mesh;
}

}  // namespace cgcontact
