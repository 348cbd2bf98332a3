/// Surface of a body that is given by its cells alone.
#pragma once

#include "core/drawing/clip_cells.hpp"

namespace cgcontact {

/// Sets the boundary of a mesh to the faces that one polyhedron has and no other, outward, with the cells and levels of
/// their polyhedra. Squares are divided as cut cells are, so that tetrahedra beside a hexahedron close it; where cells
/// of two sizes meet, faces inside the body are left, which nobody sees. Interior cells of the mesh are not looked at.
void find_boundary(ClippedMesh& mesh);

}  // namespace cgcontact
