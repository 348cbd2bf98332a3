/// Integrals of the stress term of a contact edge over the cells of a patch.
#pragma once

#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/contact_edge.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact {

/// Integrates the term times the polynomials about `centre`, lengths in `unit` (both grid coordinates), over the
/// material in the cells, each over its own volume; component, term. 27 points per cell (eight in full cells away from
/// the edge); for the square root at an edge inside the cell that is good to 1 %, and 125 points change the pressures
/// by less than 5 % of their error.
template <int degree>
Eigen::Matrix<double, 6 * Polynomial<degree>::num_terms, 1> edge_moments(const BodyMesh& mesh, const int* cells,
                                                                         int num_cells, const Vec3& centre,
                                                                         const ContactEdge& edge, double unit = 1);

/// Takes `factor` times the term out of a fit on these cells with that mass matrix (lower triangle by rows): subtracts
/// the polynomials of its degree nearest to it from the coefficients a (component, term).
template <int degree>
void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const Vec3& centre, double unit,
                        const ContactEdge& edge, double factor, const double* mass, double* a);

}  // namespace cgcontact
