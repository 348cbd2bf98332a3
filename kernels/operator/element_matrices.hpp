/// Stiffness matrices of the cells and the ghost-penalty face matrix.
#pragma once

#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Ghost penalty gamma (2 mu + lambda) sum over orders l of h^(2l-1) / l!^2 int_F [d_n^l u] . [d_n^l v], l = 1 ..
/// degree (Burman, Ghost penalty, C. R. Acad. Sci. Paris 348 (2010)): one matrix per component serves the faces of all
/// directions; rows and columns: nodes of GhostFace.
template <int degree>
using GhostMatrixOf = std::array<std::array<double, GhostFace<degree>::num_nodes>, GhostFace<degree>::num_nodes>;
using GhostMatrix = GhostMatrixOf<1>;

/// Matrix 0 is that of interior cells of level 0, matrix 1 + c that of cut cell c: sum_q w_q B_q^T D B_q with the
/// weights fitted to the cell's moments, and the support terms. Units: Scales::stress * Scales::length. 4.6 kB per cut
/// cell: for the plain operator and for assembly. soft_axis: SoftCells of the body (degree 1), empty: none.
template <int degree = 1>
CellMatrixViewOf<degree> make_cell_matrices(const BodyMesh& mesh, const std::vector<SupportTerm>& supports,
                                            const std::vector<signed char>& soft_axis = {});

template <int degree = 1>
GhostMatrixOf<degree> make_ghost_matrix(const BodyMesh& mesh, double gamma);

/// Factor of that matrix on the face between two active cells, 0 where is_ghost_face says no. Where coarse cells are
/// wider than the body is thick it is (thickness / width)^3, as the bending stiffness: the jump of d_n u is not zero
/// where a plate bends, and the full penalty held free edges.
double ghost_scale(const BodyMesh& mesh, int e, int f);

}  // namespace cgcontact
