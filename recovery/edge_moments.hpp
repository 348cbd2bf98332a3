/// Integrals of the stress term of a contact edge over the cells of a patch.
#pragma once

#include "kernels/mesh.hpp"
#include "recovery/contact_edge.hpp"
#include "recovery/patch_problem.hpp"

namespace cgcontact {

/// Over the body's part of the cells, cell units: W is the term, P the polynomials about a centre, sigma_h the stress.
template <int degree>
struct EdgeMoments {
  Eigen::Matrix<double, 6 * Polynomial<degree>::num_terms, 1> with_polynomials;  ///< P^T W; component, term
  double square = 0, with_stress = 0;                                            ///< W : W, W : sigma_h
};

/// u: displacements of all bodies; empty: with_stress is not computed. 27 points per cell for degree 1; for the square
/// root at an edge inside the cell that is good to 1 %, and the fit uses the same points throughout. 125 points for
/// degree 2, whose fitted weights carry the products of quadratic terms.
template <int degree>
EdgeMoments<degree> edge_moments(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge,
                                 const Vec3& centre, const RealView& u);

/// Takes `factor` times the term out of a fit on these cells: subtracts the polynomials of its degree nearest to that.
void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
                        PatchFit& fit);

}  // namespace cgcontact
