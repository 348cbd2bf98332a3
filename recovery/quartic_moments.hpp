/// Integrals of all monomials up to degree 4 over parts of cells: what the mass matrices of quadratic polynomials need.
#pragma once

#include <array>

#include "core/cut_cells.hpp"
#include "recovery/polynomials.hpp"

namespace cgcontact {

/// Place of x^i y^j z^k, i + j + k <= 4, among the 35 monomials: by i, then j, then k.
constexpr int quartic_index(int i, int j, int k) {
  int index = 0;
  for (int a = 0; a < i; ++a) index += (5 - a) * (6 - a) / 2;
  for (int b = 0; b < j; ++b) index += 5 - i - b;
  return index + k;
}
constexpr int num_quartics = 35;

/// Integrals of the monomials about some centre, cell units (a full cell has volume 1).
using QuarticMoments = std::array<double, num_quartics>;

/// Those over the body's part of a cell, about the cell's centre.
QuarticMoments quartic_moments(const Moments& moments);

/// The same integrals about another centre: `d` is the old centre seen from the new one.
void shift_moments(const double d[3], QuarticMoments& moments);

using QuadraticMass = Eigen::Matrix<double, Polynomial<2>::num_terms, Polynomial<2>::num_terms>;

/// Integrals of the products of the ten terms of Polynomial<2>.
QuadraticMass quadratic_mass(const QuarticMoments& moments);

/// Integrals of the ten terms times something, about another centre; `d` as above.
inline void shift_terms(const double d[3], const double h[10], double shifted[10]) {
  shifted[0] = h[0];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    shifted[1 + i] = h[1 + i] + d[i] * h[0];
    shifted[4 + i] = h[4 + i] + d[i] * (2 * h[1 + i] + d[i] * h[0]);
    shifted[7 + i] = h[7 + i] + d[i] * h[1 + j] + d[j] * h[1 + i] + d[i] * d[j] * h[0];
  }
}

}  // namespace cgcontact
