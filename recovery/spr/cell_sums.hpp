/// Integrals over many cells about one centre. Moving a centre along one axis touches few of them, so cells are added
/// line by line: along x to the middle of their line, lines along y to that of their layer, layers along z.
#pragma once

#include "recovery/patch/quartic_moments.hpp"

namespace cgcontact {

/// Integrals over some cells about a centre, cell units. Components of the stress come in eights, the last two of them
/// idle: one vector of the processor.
struct CellSums {
  static constexpr int num_stress = 10, num_components = 8;
  double stress[num_stress][num_components];  ///< terms of Polynomial<2> times components
  double moments[num_quartics];               ///< monomials up to degree 4 (quartic_index)
  double square;                              ///< stress : stress

  /// Adds integrals about another centre, which lies at `d` along an axis as seen from this one.
  template <int axis>
  KOKKOS_FORCEINLINE_FUNCTION void add(const double* from_stress, const double* from_moments, double from_square,
                                       double d);
  template <int axis>
  KOKKOS_FORCEINLINE_FUNCTION void add(const CellSums& from, double d) {
    add<axis>(from.stress[0], from.moments, from.square, d);
  }
  /// Adds integrals about this centre whose coordinates are those of this times 1 / scale; volumes count as they are.
  KOKKOS_FORCEINLINE_FUNCTION void add_scaled(const CellSums& from, double scale) {
    for (int t = 0; t < num_stress; ++t) {
      const double factor = t == 0 ? 1 : t < 4 ? scale : scale * scale;
      for (int k = 0; k < num_components; ++k) stress[t][k] += factor * from.stress[t][k];
    }
    const double power[5] = {1, scale, scale * scale, scale * scale * scale, scale * scale * scale * scale};
    for (int i = 0; i < 5; ++i)
      for (int j = 0; i + j < 5; ++j)
        for (int k = 0; i + j + k < 5; ++k) {
          const int q = quartic_index(i, j, k);
          moments[q] += power[i + j + k] * from.moments[q];
        }
    square += from.square;
  }
};

/// Returns the index of x_axis^i times the other two to the powers b and c.
template <int axis>
KOKKOS_FORCEINLINE_FUNCTION constexpr int quartic_along(int i, int b, int c) {
  return axis == 0 ? quartic_index(i, b, c) : axis == 1 ? quartic_index(b, i, c) : quartic_index(b, c, i);
}

/// Adds to `moments` those about a centre at `d` along the axis: the binomial theorem, in loops over monomials of one
/// power along the axis.
template <int axis>
KOKKOS_FORCEINLINE_FUNCTION void add_moments(const double* from, double d, double* moments) {
  constexpr int binomial[5][5] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}};
  double power[5] = {1, d, d * d, d * d * d, d * d * d * d};
#pragma GCC unroll 5
  for (int i = 0; i < 5; ++i)
#pragma GCC unroll 5
    for (int k = 0; k <= i; ++k) {
      const double factor = binomial[i][k] * power[i - k];
#pragma GCC unroll 5
      for (int degree = 0; degree < 5 - i; ++degree)  // of the other two
#pragma GCC unroll 5
        for (int c = 0; c <= degree; ++c)
          moments[quartic_along<axis>(i, degree - c, c)] += factor * from[quartic_along<axis>(k, degree - c, c)];
    }
}

template <int axis>
KOKKOS_FORCEINLINE_FUNCTION void CellSums::add(const double* from_stress, const double* from_moments,
                                               double from_square, double d) {
  constexpr int b = (axis + 1) % 3, c = (axis + 2) % 3;
  constexpr int linear = 1 + axis, quadratic = 4 + axis, with_b = 7 + axis, with_c = 7 + c;
  const auto at = [from_stress](int term, int k) { return from_stress[num_components * term + k]; };
  for (int k = 0; k < num_components; ++k) {
    stress[0][k] += at(0, k);
    stress[linear][k] += at(linear, k) + d * at(0, k);
    stress[1 + b][k] += at(1 + b, k);
    stress[1 + c][k] += at(1 + c, k);
    stress[quadratic][k] += at(quadratic, k) + d * (2 * at(linear, k) + d * at(0, k));
    stress[4 + b][k] += at(4 + b, k);
    stress[4 + c][k] += at(4 + c, k);
    stress[with_b][k] += at(with_b, k) + d * at(1 + b, k);
    stress[with_c][k] += at(with_c, k) + d * at(1 + c, k);
    stress[7 + b][k] += at(7 + b, k);
  }
  add_moments<axis>(from_moments, d, moments);
  square += from_square;
}

}  // namespace cgcontact
