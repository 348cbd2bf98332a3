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
  double square = 0, with_stress = 0;  ///< W : W, W : sigma_h (0 if it is not known)
};

/// The cells of a patch, ready for the integrals of any number of edges. 27 points per cell; for the square root at an
/// edge inside the cell that is good to 1 %, and a fit uses the same points throughout (125 points: docs/recovery.md).
/// Polynomials of degree 2 take 125 points, whose fitted weights carry the products of quadratic terms.
template <int degree>
class EdgeQuadrature {
 public:
  /// u: displacements of all bodies; empty: sigma_h is not known.
  EdgeQuadrature(const BodyMesh& mesh, const int* cells, int num_cells, const Vec3& centre, const RealView& u);

  EdgeMoments<degree> moments(const ContactEdge& edge) const;

 private:
  static constexpr int n = degree == 1 ? 3 : 5, num_points = n * n * n;
  /// The points run along the rows, so that the loops over them are vectorised.
  using Row = std::array<double, num_points>;
  struct Cell {
    Row weight;
    std::array<Row, 3> position;  ///< grid coordinates
    std::array<Row, 6> stress;
  };
  static void set_plane_term(const Cell& cell, const ContactEdge& edge, std::array<Row, 6>& term);

  std::vector<Cell> cells_;
  Vec3 centre_;
  bool with_stress_;
};

/// Takes `factor` times the term out of a fit on these cells: subtracts the polynomials of its degree nearest to that.
void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
                        PatchFit& fit);

}  // namespace cgcontact
