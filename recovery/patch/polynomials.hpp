/// Complete polynomials of degree 1 and 2 for six stress components, and what must hold inside a body for their
/// coefficients: equilibrium and, from degree 2 on, compatibility (Beltrami-Michell).
///
/// Components xx, yy, zz, xy, yz, zx; terms 1, x, y, z and xx, yy, zz, xy, yz, zx, in cell units about the patch's
/// centre. Interior rows, by coefficients of the polynomials that must vanish:
///   0 .. 2             (div sigma)_i at the centre
///   3 + 3 k + i        coefficient of x_k in (div sigma)_i                                    (degree 2)
///   12 + component ij  Laplace sigma_ij + 1/(1 + nu) d_i d_j trace sigma, a constant          (degree 2)
/// 3 and 18 independent rows. `Real`: see lane_math.hpp.
#pragma once

#include "kernels/simd/lane_math.hpp"  // its vectors pass through the templates here

namespace cgcontact {

/// Returns the component of sigma_ij; 4 + it is the term x_i x_j.
KOKKOS_FORCEINLINE_FUNCTION constexpr int component_of(int i, int j) {
  return i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5;
}

template <int degree>
struct Polynomial {
  static_assert(degree == 1 || degree == 2, "complete polynomials of degree 1 and 2");
  static constexpr int num_terms = degree == 1 ? 4 : 10;
  static constexpr int num_interior = degree == 1 ? 3 : 18;
  static constexpr int num_packed = num_terms * (num_terms + 1) / 2;  ///< lower triangle, by rows

  /// Evaluates the terms at offset d (cell units).
  template <class Real>
  static KOKKOS_FORCEINLINE_FUNCTION void terms(const Real d[3], Real p[num_terms]) {
    p[0] = Real{} + 1;
    for (int i = 0; i < 3; ++i) p[1 + i] = d[i];
    if constexpr (degree == 2) {
      for (int i = 0; i < 3; ++i) p[4 + i] = d[i] * d[i];
      p[7] = d[0] * d[1], p[8] = d[1] * d[2], p[9] = d[2] * d[0];
    }
  }

  /// Computes out[r] = interior row r times the coefficients x(component, term). g: 1/(1 + nu), not used by degree 1.
  template <class Real, class Coefficients>
  static KOKKOS_FORCEINLINE_FUNCTION void interior(const Coefficients& x, const Real& g, Real* out) {
    for (int i = 0; i < 3; ++i) out[i] = x(component_of(i, 0), 1) + x(component_of(i, 1), 2) + x(component_of(i, 2), 3);
    if constexpr (degree == 2) {
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
          Real sum = 2.0 * x(component_of(i, k), 4 + k);
          for (int j = 0; j < 3; ++j)
            if (j != k) sum += x(component_of(i, j), 4 + component_of(j, k));
          out[3 + 3 * k + i] = sum;
        }
      for (int c = 0; c < 6; ++c) {
        const Real trace = x(0, 4 + c) + x(1, 4 + c) + x(2, 4 + c);
        out[12 + c] = 2.0 * (x(c, 4) + x(c, 5) + x(c, 6)) + (c < 3 ? 2.0 : 1.0) * g * trace;
      }
    }
  }

  /// Calls visit(component, term, entry) for the entries of interior row r; one index may come twice.
  template <class Real, class Visit>
  static KOKKOS_FORCEINLINE_FUNCTION void visit_row(int r, const Real& g, const Visit& visit) {
    if (degree == 1 || r < 3) {
      for (int j = 0; j < 3; ++j) visit(component_of(r, j), 1 + j, Real{} + 1);
    } else if (r < 12) {
      const int k = (r - 3) / 3, i = (r - 3) % 3;
      for (int j = 0; j < 3; ++j) visit(component_of(i, j), 4 + component_of(j, k), Real{} + (j == k ? 2 : 1));
    } else {
      const int c = r - 12;
      for (int j = 0; j < 3; ++j) visit(c, 4 + j, Real{} + 2);
      for (int m = 0; m < 3; ++m) visit(m, 4 + c, (c < 3 ? 2.0 : 1.0) * g);
    }
  }

  /// Computes the values of the interior rows. f: body force times cell size over the unit of stress; df[i][k]: its
  /// derivative d f_i / d x_k per cell unit (degree 2); nu: Poisson ratio (degree 2).
  static void interior_values(const double f[3], const double df[3][3], double nu, double values[num_interior]) {
    for (int i = 0; i < 3; ++i) values[i] = -f[i];
    if constexpr (degree == 2) {
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) values[3 + 3 * k + i] = -df[i][k];
      const double divergence = df[0][0] + df[1][1] + df[2][2];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
          values[12 + component_of(i, j)] = -(i == j ? nu / (1 - nu) * divergence : 0.0) - df[i][j] - df[j][i];
    }
  }
};

}  // namespace cgcontact
