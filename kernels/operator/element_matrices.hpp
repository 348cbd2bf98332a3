/// Stiffness matrices of the cells and the ghost-penalty face matrix.
#pragma once

#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Ghost penalty gamma (2 mu + lambda) h int_F [d_n u] . [d_n v]: one 12 x 12 matrix per component serves the faces of
/// all directions; row and column = layer * 4 + tangential corner.
using GhostMatrix = std::array<std::array<double, 12>, 12>;

/// Matrix 0 is the interior cell's, matrix 1 + c that of cut cell c: sum_q w_q B_q^T D B_q with the weights fitted to
/// the cell's moments, and the support terms. Units: Scales::stress * Scales::length. 4.6 kB per cut cell: for the
/// plain operator and for assembly. soft_axis: SoftCells of the body, empty: none.
CellMatrixView make_cell_matrices(const BodyMesh& mesh, const std::vector<SupportTerm>& supports,
                                  const std::vector<signed char>& soft_axis = {});

GhostMatrix make_ghost_matrix(const BodyMesh& mesh, double gamma);

/// Factor of that matrix on the face between two active cells, 0 where is_ghost_face says no. Where coarse cells are
/// wider than the body is thick it is (thickness / width)^3, as the bending stiffness: the jump of d_n u is not zero
/// where a plate bends, and the full penalty held free edges.
double ghost_scale(const BodyMesh& mesh, int e, int f);

}  // namespace cgcontact
