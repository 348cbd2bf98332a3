/// Cells and ghost-penalty faces of one body by colour, for the plain operator and for assembly (some 15 bytes per
/// unknown: a computation does not keep them).
#pragma once

#include <vector>

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

struct ColouredMesh {
  CellNodesView nodes_of_cell;    ///< BodyMesh::cell_nodes, cells ordered by colour
  IntView matrix_of_cell;         ///< 0: interior, 1 + cut index otherwise; same order
  std::vector<int> colour_begin;  ///< first cell of each colour, and the end (9 entries)

  FaceNodesView nodes_of_face;  ///< ghost faces by colour: layer * 4 + tangential corner
  RealView scale_of_face;       ///< ghost_scale, same order
  std::vector<int> face_colour_begin;
};

ColouredMesh colour_mesh(const BodyMesh& mesh);

}  // namespace cgcontact
