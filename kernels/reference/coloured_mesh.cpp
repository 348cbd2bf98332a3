#include "kernels/reference/coloured_mesh.hpp"

#include <algorithm>

#include "kernels/operator/element_matrices.hpp"

namespace cgcontact {
namespace {

/// Cells of one colour share no node: parity of the cell index in each direction.
void colour_cells(const BodyMesh& mesh, ColouredMesh& coloured) {
  const CutCells& cc = *mesh.cut_cells;
  const int n = static_cast<int>(cc.cells.size());
  coloured.nodes_of_cell = CellNodesView("cgcontact::coloured_mesh::nodes_of_cell", n);
  coloured.matrix_of_cell = IntView("cgcontact::coloured_mesh::matrix_of_cell", n);
  auto nodes_host = Kokkos::create_mirror_view(coloured.nodes_of_cell);
  auto matrix_host = Kokkos::create_mirror_view(coloured.matrix_of_cell);
  coloured.colour_begin.assign(1, 0);
  int position = 0;
  for (int colour = 0; colour < 8; ++colour) {
    for (int e = 0; e < n; ++e) {
      const Index3& c = cc.cells[e];
      if ((c[0] & 1) + 2 * (c[1] & 1) + 4 * (c[2] & 1) != colour) continue;
      for (int a = 0; a < 8; ++a) nodes_host(position, a) = mesh.cell_nodes[e][a];
      matrix_host(position) = 1 + cc.cut_of_active[e];
      ++position;
    }
    coloured.colour_begin.push_back(position);
  }
  Kokkos::deep_copy(coloured.nodes_of_cell, nodes_host);
  Kokkos::deep_copy(coloured.matrix_of_cell, matrix_host);
}

struct GhostFace {
  int colour;
  double scale;
  std::array<int, 12> nodes;
};

std::vector<GhostFace> ghost_faces(const BodyMesh& mesh) {
  const CutCells& cc = *mesh.cut_cells;
  std::vector<GhostFace> faces;
  for (std::size_t e = 0; e < cc.cells.size(); ++e)
    for (int d = 0; d < 3; ++d) {
      Index3 c = cc.cells[e];
      ++c[d];
      const int f = cc.find(c);
      const double scale = f < 0 ? 0 : ghost_scale(mesh, e, f);
      if (scale == 0) continue;
      const int t1 = (d + 1) % 3, t2 = (d + 2) % 3;
      GhostFace face;
      face.scale = scale;
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

void colour_faces(const BodyMesh& mesh, ColouredMesh& coloured) {
  std::vector<GhostFace> faces = ghost_faces(mesh);
  std::stable_sort(faces.begin(), faces.end(),
                   [](const GhostFace& a, const GhostFace& b) { return a.colour < b.colour; });
  coloured.nodes_of_face = FaceNodesView("cgcontact::coloured_mesh::nodes_of_face", faces.size());
  coloured.scale_of_face = RealView("cgcontact::coloured_mesh::scale_of_face", faces.size());
  auto host = Kokkos::create_mirror_view(coloured.nodes_of_face);
  auto scale = Kokkos::create_mirror_view(coloured.scale_of_face);
  coloured.face_colour_begin.clear();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (f == 0 || faces[f].colour != faces[f - 1].colour) coloured.face_colour_begin.push_back(static_cast<int>(f));
    for (int a = 0; a < 12; ++a) host(f, a) = faces[f].nodes[a];
    scale(f) = faces[f].scale;
  }
  coloured.face_colour_begin.push_back(static_cast<int>(faces.size()));
  Kokkos::deep_copy(coloured.nodes_of_face, host);
  Kokkos::deep_copy(coloured.scale_of_face, scale);
}

}  // namespace

ColouredMesh colour_mesh(const BodyMesh& mesh) {
  ColouredMesh coloured;
  colour_cells(mesh, coloured);
  colour_faces(mesh, coloured);
  return coloured;
}

}  // namespace cgcontact
