/// Legendre moments of cells: basis, changes of cell.
#pragma once

#include "core/cells/cut_cells.hpp"

namespace cgcontact {

/// Values of L_0 .. L_4 at x.
inline void legendre_values(double x, double value[moment_degree + 1]) {
  value[0] = 1;
  value[1] = x;
  for (int k = 2; k <= moment_degree; ++k) value[k] = ((2 * k - 1) * x * value[k - 1] - (k - 1) * value[k - 2]) / k;
}

/// Integrals of L_0 .. L_4 from -1 to x.
inline void legendre_integrals(double x, double value[moment_degree + 1]) {
  double l[moment_degree + 2] = {1, x};
  for (int k = 2; k <= moment_degree + 1; ++k) l[k] = ((2 * k - 1) * x * l[k - 1] - (k - 1) * l[k - 2]) / k;
  value[0] = x + 1;
  for (int k = 1; k <= moment_degree; ++k) value[k] = (l[k + 1] - l[k - 1]) / (2 * k + 1);
}

/// moments += weight a_i b_j c_k.
inline void add_product(Moments& moments, double weight, const double* a, const double* b, const double* c) {
  constexpr int n = moment_degree + 1;
  double bc[n * n];
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < n; ++k) bc[j * n + k] = weight * b[j] * c[k];
  for (int i = 0; i < n; ++i)
    for (int q = 0; q < n * n; ++q) moments[i * n * n + q] += a[i] * bc[q];
}

/// The same integrals expressed in the coordinates of another cell: the old cell lies `offset` cells further (the old
/// centre has the coordinates 2 offset).
Moments shifted_moments(const Moments& moments, const Index3& offset);

}  // namespace cgcontact
