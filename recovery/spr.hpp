/// Superconvergent patch recovery without constraints (paper, equation 1), and the evaluation of the recovered field.
/// Stresses are in units of Scales::stress, components in the grid axes of the body.
#pragma once

#include "recovery/patches.hpp"

namespace cgcontact {

/// Integrals of {1,x,y,z} sigma_h over the listed active cells (all cells if the list is empty).
/// u: displacements of all bodies (3 per node). About 8 kflop per cell.
template <class Exec, class U>
void integrate_cell_stress(const Exec& exec, const BodyMesh& mesh, const PatchSet& patches, const IntView& cells,
                           const U& u, const CellStressView& out) {
  const auto nodes = patches.nodes_of_cell;
  const auto weights = patches.weights;
  const auto weights_of_cell = patches.weights_of_cell;
  const UnitElasticity law = mesh.law;
  const double factor = mesh.stress_factor();
  const bool all = cells.extent(0) == 0;
  const int count = static_cast<int>(all ? nodes.extent(0) : cells.extent(0));
  Kokkos::parallel_for(
      "cgcontact::spr::cell_stress", Kokkos::RangePolicy<Exec>(exec, 0, count), KOKKOS_LAMBDA(const int index) {
        const int cell = all ? index : cells(index);
        double corner[8][3], sum[6][num_terms] = {};
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i) corner[a][i] = u(3 * nodes(cell, a) + i);
        for (int q = 0; q < 27; ++q) {
          const double xi[3] = {Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]};
          const double w = factor * weights(27 * weights_of_cell(cell) + q) / 8;
          double s[6];
          hex_stress(law, corner, xi, s);
          for (int k = 0; k < 6; ++k) {
            sum[k][0] += w * s[k];
            for (int d = 0; d < 3; ++d) sum[k][1 + d] += 0.5 * w * xi[d] * s[k];
          }
        }
        for (int k = 0; k < 6; ++k)
          for (int t = 0; t < num_terms; ++t) out(cell, k, t) = sum[k][t];
      });
}

/// Sums of the patch's cells, shifted to the node: mass matrix m (4 x 4) and right-hand side H (6 x 4).
template <class Mass, class Stress, class Patches, class Offsets>
KOKKOS_INLINE_FUNCTION void gather_patch(const Patches& cells, int first, int last, const Offsets& offset_of_cell,
                                         const Mass& mass, const Stress& stress, double m[num_terms][num_terms],
                                         double H[6][num_terms]) {
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) m[i][j] = 0;
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < num_terms; ++i) H[k][i] = 0;
  for (int p = first; p < last; ++p) {
    const int c = cells(p);
    double d[3];  // centre of the cell relative to the node
    offset_of_cell(c, d);
    const double v = mass(c, 0), s[3] = {mass(c, 1), mass(c, 2), mass(c, 3)};
    const double second[3][3] = {{mass(c, 4), mass(c, 7), mass(c, 9)},
                                 {mass(c, 7), mass(c, 5), mass(c, 8)},
                                 {mass(c, 9), mass(c, 8), mass(c, 6)}};
    m[0][0] += v;
    for (int i = 0; i < 3; ++i) {
      m[0][1 + i] += s[i] + v * d[i];
      for (int j = 0; j < 3; ++j) m[1 + i][1 + j] += second[i][j] + d[i] * s[j] + d[j] * s[i] + v * d[i] * d[j];
    }
    for (int k = 0; k < 6; ++k) {
      H[k][0] += stress(c, k, 0);
      for (int i = 0; i < 3; ++i) H[k][1 + i] += stress(c, k, 1 + i) + d[i] * stress(c, k, 0);
    }
  }
  for (int i = 0; i < 3; ++i) m[1 + i][0] = m[0][1 + i];
}

/// In-place Cholesky factor (lower) of a 4 x 4 mass matrix; false if it is not positive definite.
KOKKOS_INLINE_FUNCTION bool cholesky(double m[num_terms][num_terms]) {
  for (int j = 0; j < num_terms; ++j) {
    double diagonal = m[j][j];
    for (int k = 0; k < j; ++k) diagonal -= m[j][k] * m[j][k];
    if (!(diagonal > 1e-14 * m[j][j])) return false;
    m[j][j] = sqrt(diagonal);
    for (int i = j + 1; i < num_terms; ++i) {
      double sum = m[i][j];
      for (int k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      m[i][j] = sum / m[j][j];
    }
  }
  return true;
}

/// Solves L L^T a = b in place.
KOKKOS_INLINE_FUNCTION void cholesky_solve(const double L[num_terms][num_terms], double b[num_terms]) {
  for (int i = 0; i < num_terms; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
    b[i] /= L[i][i];
  }
  for (int i = num_terms - 1; i >= 0; --i) {
    for (int k = i + 1; k < num_terms; ++k) b[i] -= L[k][i] * b[k];
    b[i] /= L[i][i];
  }
}

/// Unconstrained fit (equation 1) of the listed nodes of one body (numbers within the body; all if empty).
/// Returns the number of patches whose mass matrix was singular (their polynomial is the constant mean stress).
int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const IntView& nodes, const CellStressView& stress,
                const CoefficientView& coefficients);

/// sigma*(x) = sum_v N_v(x) P_v(x) A_v at cell coordinates xi of a cell (conjoint polynomials).
template <class Coefficients>
inline void evaluate_recovered(const BodyMesh& mesh, const Coefficients& coefficients, int cell, const double xi[3],
                               double s[6]) {
  double N[8];
  hex_shape(xi, N);
  for (int k = 0; k < 6; ++k) s[k] = 0;
  for (int a = 0; a < 8; ++a) {
    const int node = mesh.cell_nodes[cell][a] - mesh.first_node;
    const double d[3] = {0.5 * (xi[0] + 1) - (a & 1), 0.5 * (xi[1] + 1) - (a >> 1 & 1), 0.5 * (xi[2] + 1) - (a >> 2)};
    for (int k = 0; k < 6; ++k)
      s[k] += N[a] * (coefficients(node, k, 0) + coefficients(node, k, 1) * d[0] + coefficients(node, k, 2) * d[1] +
                      coefficients(node, k, 3) * d[2]);
  }
}

}  // namespace cgcontact
