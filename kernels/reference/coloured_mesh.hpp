/// Cells and ghost-penalty faces of one body by colour, for the plain operator and for assembly (some 15 bytes per
/// unknown: a computation does not keep them).
#pragma once

#include <vector>

#include "kernels/mesh/element_nodes.hpp"
#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

template <int degree>
struct ColouredMeshOf {
  CellNodesViewOf<degree> nodes_of_cell;  ///< node numbers, cells ordered by colour
  IntView matrix_of_cell;                 ///< 0: interior, 1 + cut index otherwise; same order
  std::vector<int> colour_begin;          ///< first cell of each colour, and the end (9 entries)

  FaceNodesViewOf<degree> nodes_of_face;  ///< ghost faces by colour: nodes of GhostFace
  RealView ring_of_face;                  ///< BodyMesh::ring_of_face, a factor of the penalty
  std::vector<int> face_colour_begin;
};
using ColouredMesh = ColouredMeshOf<1>;

/// cell_nodes: node numbers of each active cell.
template <int degree>
ColouredMeshOf<degree> colour_mesh(const BodyMesh& mesh,
                                   const std::vector<std::array<int, HexElement<degree>::num_nodes>>& cell_nodes);
inline ColouredMesh colour_mesh(const BodyMesh& mesh) { return colour_mesh<1>(mesh, mesh.cell_nodes); }

}  // namespace cgcontact
