#include "kernels/mesh.hpp"

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

/// Cells of one colour share no node: parity of the cell index in each direction.
void colour_cells(BodyMesh& mesh) {
  const CutCells& cc = *mesh.cut_cells;
  const int n = static_cast<int>(cc.cells.size());
  mesh.nodes_of_cell = CellNodesView("cgcontact::mesh::nodes_of_cell", n);
  mesh.matrix_of_cell = IntView("cgcontact::mesh::matrix_of_cell", n);
  auto nodes_host = Kokkos::create_mirror_view(mesh.nodes_of_cell);
  auto matrix_host = Kokkos::create_mirror_view(mesh.matrix_of_cell);
  mesh.colour_begin.assign(1, 0);
  int position = 0;
  for (int colour = 0; colour < 8; ++colour) {
    for (int e = 0; e < n; ++e) {
      const Index3& c = cc.cells[e];
      if ((c[0] & 1) + 2 * (c[1] & 1) + 4 * (c[2] & 1) != colour) continue;
      for (int a = 0; a < 8; ++a) nodes_host(position, a) = mesh.cell_nodes[e][a];
      matrix_host(position) = 1 + cc.cut_of_active[e];
      ++position;
    }
    mesh.colour_begin.push_back(position);
  }
  Kokkos::deep_copy(mesh.nodes_of_cell, nodes_host);
  Kokkos::deep_copy(mesh.matrix_of_cell, matrix_host);
}

struct GhostFace {
  int colour;
  std::array<int, 12> nodes;
};

/// Faces between two active cells of which at least one is cut.
std::vector<GhostFace> ghost_faces(const BodyMesh& mesh) {
  const CutCells& cc = *mesh.cut_cells;
  std::vector<GhostFace> faces;
  for (std::size_t e = 0; e < cc.cells.size(); ++e)
    for (int d = 0; d < 3; ++d) {
      Index3 c = cc.cells[e];
      ++c[d];
      const int f = cc.find(c);
      if (f < 0 || (cc.cut_of_active[e] < 0 && cc.cut_of_active[f] < 0)) continue;
      const int t1 = (d + 1) % 3, t2 = (d + 2) % 3;
      GhostFace face;
      face.colour = ((d * 3 + c[d] % 3) * 2 + (c[t1] & 1)) * 2 + (c[t2] & 1);
      for (int layer = 0; layer < 3; ++layer)
        for (int t = 0; t < 4; ++t) {
          const int along = layer == 2 ? 1 : layer;
          const int corner = ((layer == 2 ? 1 : along) << d) | ((t & 1) << t1) | ((t >> 1) << t2);
          face.nodes[layer * 4 + t] = mesh.cell_nodes[layer == 2 ? f : e][corner];
        }
      faces.push_back(face);
    }
  return faces;
}

void colour_faces(BodyMesh& mesh) {
  std::vector<GhostFace> faces = ghost_faces(mesh);
  std::stable_sort(faces.begin(), faces.end(),
                   [](const GhostFace& a, const GhostFace& b) { return a.colour < b.colour; });
  mesh.nodes_of_face = FaceNodesView("cgcontact::mesh::nodes_of_face", faces.size());
  auto host = Kokkos::create_mirror_view(mesh.nodes_of_face);
  mesh.face_colour_begin.clear();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (f == 0 || faces[f].colour != faces[f - 1].colour) mesh.face_colour_begin.push_back(static_cast<int>(f));
    for (int a = 0; a < 12; ++a) host(f, a) = faces[f].nodes[a];
  }
  mesh.face_colour_begin.push_back(static_cast<int>(faces.size()));
  Kokkos::deep_copy(mesh.nodes_of_face, host);
}

}  // namespace

BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node) {
  BodyMesh mesh;
  mesh.cut_cells = &cut_cells;
  mesh.law = UnitElasticity(material.poisson_ratio);
  mesh.modulus = material.youngs_modulus / scales.stress;
  mesh.cell_size = cut_cells.grid.cell_size / scales.length;
  mesh.first_node = first_node;
  number_nodes(mesh);
  colour_cells(mesh);
  colour_faces(mesh);
  return mesh;
}

}  // namespace cgcontact
