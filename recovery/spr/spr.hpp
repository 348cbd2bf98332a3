/// Superconvergent patch recovery without constraints (paper, equation 1), and the evaluation of the recovered field.
/// Stresses are in units of Scales::stress, components in the grid axes of the body.
#pragma once

#include <array>
#include <memory>

#include "recovery/patch/contact_edge.hpp"
#include "recovery/patch/patches.hpp"
#include "recovery/patch/subset.hpp"
#include "recovery/spr/interior_fit.hpp"

namespace cgcontact {

/// The quadratic terms of those nodes of a body whose polynomials have degree 2.
struct QuadraticTerms {
  static constexpr int count = 6;                           ///< xx, yy, zz, xy, yz, zx about the node, in its unit
  using Values = std::array<std::array<double, count>, 6>;  ///< component, term
  std::vector<int> row_of_node;                             ///< node -> row of values, or -1; empty: no node has any
  std::vector<Values> values;

  const Values* of_node(int node) const {
    if (row_of_node.empty() || row_of_node[node] < 0) return nullptr;
    return &values[row_of_node[node]];
  }
};

/// The 6 x 4 coefficients of a node.
using Coefficients = std::array<double, 6 * num_terms>;

/// Polynomials of some or all nodes of one body, about their positions, in units of the cells of their levels (which
/// those of all corners of a cell are).
struct RecoveredField {
  Subset nodes;                                          ///< that are stored
  CoefficientView values;                                ///< row of the subset, component, term
  std::shared_ptr<const EdgeTerms> edge = {};            ///< beside the polynomials; may be empty
  std::shared_ptr<const QuadraticTerms> quadratic = {};  ///< of nodes with degree 2; may be empty
  std::shared_ptr<const InteriorFit> interior = {};      ///< makes those of all other nodes; may be empty
  /// Returns the coefficients of a stored node (number within the body).
  const double* at(int node) const {
    return values.data() + 6 * num_terms * static_cast<std::ptrdiff_t>(nodes.row(node));
  }
  /// Returns the polynomial of any node; made in `space` if it is not stored.
  const double* polynomial(int node, Coefficients& space) const {
    if (nodes.row(node) >= 0) return at(node);
    interior->at(node, space.data());
    return space.data();
  }
};

/// Copies a field for some nodes; of no others.
RecoveredField restricted_field(const RecoveredField& field, Subset nodes);

/// The polynomials of the nodes of successive cells, so that those that are not stored are made once. Refers to the
/// field.
class PolynomialBlock {
 public:
  PolynomialBlock(const BodyMesh& mesh, const RecoveredField& field, std::size_t first_cell, std::size_t end_cell);
  const double* at(int node) const {
    const int row = row_.empty() ? -1 : row_[node - first_];
    return row < 0 ? field_.at(node) : values_[row].data();
  }

 private:
  const RecoveredField& field_;
  int first_ = 0;         ///< node that row_ begins with
  std::vector<int> row_;  ///< of values_, -1: stored in the field; empty: all are
  std::vector<Coefficients> values_;
};

/// Integrals of {1, x, y, z} sigma_h over a body's cells; one row of `out` for each. u: displacements of all bodies (3
/// per node).
void integrate_cell_stress(const BodyMesh& mesh, const PatchSet& patches, const Subset& cells, const RealView& u,
                           const CellStressView& out);

/// Returns the cells of the patches of some nodes.
Subset cells_of_patches(const BodyMesh& mesh, const PatchSet& patches, const Subset& nodes);

/// Sets the polynomials of the constrained nodes of a field to the means of their masters', which it holds as well;
/// where masters are of degree 2 those of `quadratic` too.
void set_constrained_nodes(const BodyMesh& mesh, const RecoveredField& field, QuadraticTerms* quadratic = nullptr);

/// Fits (unconstrained, equation 1) the nodes of field.nodes, among them the masters of those that are constrained;
/// `stress` holds the cells of their patches. Returns the number of patches whose mass matrix was singular (their
/// polynomial is the constant mean stress).
int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const CellStressView& stress, const Subset& stressed,
                const RecoveredField& field);

/// Fits all nodes of a field to the displacements, in chunks: the integrals of all cells would take as much memory as
/// the field. Returns the number of singular patches. Collective.
int recover_all(const BodyMesh& mesh, const PatchSet& patches, const RealView& u, const RecoveredField& field,
                int nodes_per_chunk = 200000);

/// Adds what the terms of the contact edges at a cell's nodes contribute. N: shape functions at xi.
void add_edge_terms(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3], const double N[8],
                    double s[6]);

/// Adds the quadratic terms of the nodes of a cell.
void add_quadratic_terms(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3],
                         const double N[8], double s[6]);

/// Evaluates sigma*(x) = sum_v N_v(x) P_v(x) A_v at cell coordinates xi of a cell (conjoint polynomials).
inline void evaluate_recovered(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3],
                               double s[6]) {
  double N[8];
  hex_shape(xi, N);
  for (int k = 0; k < 6; ++k) s[k] = 0;
  for (int a = 0; a < 8; ++a) {
    if (N[a] == 0) continue;  // at corners one polynomial is enough
    Coefficients space;
    const double* A = field.polynomial(mesh.cell_nodes[cell][a] - mesh.first_node, space);
    const double d[3] = {0.5 * (xi[0] + 1) - (a & 1), 0.5 * (xi[1] + 1) - (a >> 1 & 1), 0.5 * (xi[2] + 1) - (a >> 2)};
    for (int k = 0; k < 6; ++k)
      s[k] += N[a] * (A[4 * k] + A[4 * k + 1] * d[0] + A[4 * k + 2] * d[1] + A[4 * k + 3] * d[2]);
  }
  if (field.quadratic) add_quadratic_terms(mesh, field, cell, xi, N, s);
  if (field.edge) add_edge_terms(mesh, field, cell, xi, N, s);
}

}  // namespace cgcontact
