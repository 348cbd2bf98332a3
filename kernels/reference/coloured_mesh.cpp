#include "kernels/reference/coloured_mesh.hpp"

#include <algorithm>

#include "kernels/operator/element_matrices.hpp"

namespace cgcontact {
namespace {

template <int degree>
using CellNodes = std::vector<std::array<int, HexElement<degree>::num_nodes>>;

/// Cells of one colour share no node: parity of the cell index in each direction.
template <int degree>
void colour_cells(const BodyMesh& mesh, const CellNodes<degree>& cell_nodes, ColouredMeshOf<degree>& coloured) {
  const CutCells& cc = *mesh.cut_cells;
  const int n = static_cast<int>(cc.cells.size());
  coloured.nodes_of_cell = CellNodesViewOf<degree>("cgcontact::coloured_mesh::nodes_of_cell", n);
  coloured.matrix_of_cell = IntView("cgcontact::coloured_mesh::matrix_of_cell", n);
  auto nodes_host = Kokkos::create_mirror_view(coloured.nodes_of_cell);
  auto matrix_host = Kokkos::create_mirror_view(coloured.matrix_of_cell);
  coloured.colour_begin.assign(1, 0);
  int position = 0;
  for (int colour = 0; colour < 8; ++colour) {
    for (int e = 0; e < n; ++e) {
      const Index3& c = cc.cells[e];
      if ((c[0] & 1) + 2 * (c[1] & 1) + 4 * (c[2] & 1) != colour) continue;
      for (int a = 0; a < HexElement<degree>::num_nodes; ++a) nodes_host(position, a) = cell_nodes[e][a];
      matrix_host(position) = 1 + cc.cut_of_active[e];
      ++position;
    }
    coloured.colour_begin.push_back(position);
  }
  Kokkos::deep_copy(coloured.nodes_of_cell, nodes_host);
  Kokkos::deep_copy(coloured.matrix_of_cell, matrix_host);
}

template <int degree>
struct ColouredFace {
  int colour;
  std::array<int, GhostFace<degree>::num_nodes> nodes;
  double ring = 1;
};

template <int degree>
std::vector<ColouredFace<degree>> ghost_faces(const BodyMesh& mesh, const CellNodes<degree>& cell_nodes) {
  using Element = HexElement<degree>;
  const CutCells& cc = *mesh.cut_cells;
  std::vector<ColouredFace<degree>> faces;
  for (std::size_t e = 0; e < cc.cells.size(); ++e)
    for (int d = 0; d < 3; ++d) {
      Index3 c = cc.cells[e];
      ++c[d];
      const int f = cc.find(c);
      if (f < 0 || !is_ghost_face(mesh, e, f)) continue;
      const int t1 = (d + 1) % 3, t2 = (d + 2) % 3;
      ColouredFace<degree> face;
      face.ring = mesh.ring_of_face(cc.cells[e], d);
      face.colour = ((d * 3 + c[d] % 3) * 2 + (c[t1] & 1)) * 2 + (c[t2] & 1);
      for (int layer = 0; layer < GhostFace<degree>::num_layers; ++layer)
        for (int t = 0; t < Element::nodes_per_face; ++t) {
          const bool upper = layer > degree;
          Index3 position;
          position[d] = upper ? layer - degree : layer;
          position[t1] = t % Element::nodes_per_line;
          position[t2] = t / Element::nodes_per_line;
          face.nodes[layer * Element::nodes_per_face + t] =
              cell_nodes[upper ? f : e][Element::node(position[0], position[1], position[2])];
        }
      faces.push_back(face);
    }
  if constexpr (degree == 1)
    for (const LevelFace& level_face : mesh.level_faces) {
      const int d = level_face.direction, t1 = (d + 1) % 3, t2 = (d + 2) % 3;
      const Index3& c = level_face.lower;
      ColouredFace<degree> face;
      face.ring = mesh.ring_of_face(c, d);
      face.colour = ((d * 3 + (c[d] + 1) % 3) * 2 + (c[t1] & 1)) * 2 + (c[t2] & 1);
      for (int n = 0; n < GhostFace<degree>::num_nodes; ++n) {
        Index3 position = c;
        position[d] += n / Element::nodes_per_face;
        position[t1] += n & 1;
        position[t2] += n >> 1 & 1;
        face.nodes[n] = mesh.find_node(position);
      }
      faces.push_back(face);
    }
  return faces;
}

template <int degree>
void colour_faces(const BodyMesh& mesh, const CellNodes<degree>& cell_nodes, ColouredMeshOf<degree>& coloured) {
  std::vector<ColouredFace<degree>> faces = ghost_faces<degree>(mesh, cell_nodes);
  std::stable_sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) { return a.colour < b.colour; });
  coloured.nodes_of_face = FaceNodesViewOf<degree>("cgcontact::coloured_mesh::nodes_of_face", faces.size());
  auto host = Kokkos::create_mirror_view(coloured.nodes_of_face);
  coloured.ring_of_face = RealView("cgcontact::coloured_mesh::ring_of_face", faces.size());
  auto ring = Kokkos::create_mirror_view(coloured.ring_of_face);
  coloured.face_colour_begin.clear();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (f == 0 || faces[f].colour != faces[f - 1].colour) coloured.face_colour_begin.push_back(static_cast<int>(f));
    for (int a = 0; a < GhostFace<degree>::num_nodes; ++a) host(f, a) = faces[f].nodes[a];
    ring(f) = faces[f].ring;
  }
  coloured.face_colour_begin.push_back(static_cast<int>(faces.size()));
  Kokkos::deep_copy(coloured.nodes_of_face, host);
  Kokkos::deep_copy(coloured.ring_of_face, ring);
}

}  // namespace

template <int degree>
ColouredMeshOf<degree> colour_mesh(const BodyMesh& mesh, const CellNodes<degree>& cell_nodes) {
  ColouredMeshOf<degree> coloured;
  colour_cells<degree>(mesh, cell_nodes, coloured);
  colour_faces<degree>(mesh, cell_nodes, coloured);
  return coloured;
}

template ColouredMeshOf<1> colour_mesh(const BodyMesh&, const CellNodes<1>&);
template ColouredMeshOf<2> colour_mesh(const BodyMesh&, const CellNodes<2>&);

}  // namespace cgcontact
