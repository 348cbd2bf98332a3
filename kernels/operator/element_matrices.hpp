/// Stiffness matrices of the cells and the ghost-penalty face matrix.
#pragma once

#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Ghost penalty gamma (2 mu + lambda at points) sum over orders l of h^(2l-1) / l!^2 int_F [d_n^l u] . [d_n^l v], l =
/// 1 .. degree (Burman, Ghost penalty, C. R. Acad. Sci. Paris 348 (2010)): one matrix per component serves the faces of
/// all directions; rows and columns: nodes of GhostFace.
template <int degree>
using GhostMatrixOf = std::array<std::array<double, GhostFace<degree>::num_nodes>, GhostFace<degree>::num_nodes>;
using GhostMatrix = GhostMatrixOf<1>;

/// Computes the cell matrices: 0 is that of interior cells of level 0, matrix 1 + c that of cut cell c: sum_q w_q B_q^T
/// D B_q with the weights fitted to the cell's moments, and the support terms. Units: Scales::stress * Scales::length.
/// 4.6 kB per cut cell: for the plain operator and for assembly.
template <int degree = 1>
CellMatrixViewOf<degree> make_cell_matrices(const BodyMesh& mesh, const std::vector<SupportTerm>& supports);

template <int degree = 1>
GhostMatrixOf<degree> make_ghost_matrix(const BodyMesh& mesh, double gamma);

}  // namespace cgcontact
