/// Integrals of all monomials up to degree 4 over parts of cells: what the mass matrices of quadratic polynomials need.
#pragma once

#include <array>

#include "core/cells/cut_cells.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact {

/// Place of x^i y^j z^k, i + j + k <= 4, among the 35 monomials: by i, then j, then k.
constexpr int quartic_index(int i, int j, int k) {
  constexpr int first[5] = {0, 15, 25, 31, 34};  // of each i
  return first[i] + j * (11 - 2 * i - j) / 2 + k;
}
constexpr int num_quartics = 35;

/// Integrals of the monomials about some centre, cell units (a full cell has volume 1).
using QuarticMoments = std::array<double, num_quartics>;

/// Those over the body's part of a cell, about the cell's centre.
QuarticMoments quartic_moments(const Moments& moments);

/// The same integrals about another centre: `d` is the old centre seen from the new one. Real: double or one cell per
/// lane.
template <class Real>
void shift_moments(const Real d[3], Real moments[num_quartics]) {
  // Along one direction with the powers a, b of the others; unrolled, all places are constants.
  const auto along = [moments](const Real& x, int size, const auto& at) __attribute__((always_inline)) {
#pragma GCC unroll 4
    for (int s = 1; s < size; ++s)
#pragma GCC unroll 4
      for (int i = size - 1; i >= s; --i) moments[at(i)] += x * moments[at(i - 1)];
  };
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a)
#pragma GCC unroll 5
    for (int b = 0; b < 5 - a; ++b) along(d[0], 5 - a - b, [=](int i) { return quartic_index(i, a, b); });
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a)
#pragma GCC unroll 5
    for (int b = 0; b < 5 - a; ++b) along(d[1], 5 - a - b, [=](int i) { return quartic_index(a, i, b); });
#pragma GCC unroll 5
  for (int a = 0; a < 5; ++a)
#pragma GCC unroll 5
    for (int b = 0; b < 5 - a; ++b) along(d[2], 5 - a - b, [=](int i) { return quartic_index(a, b, i); });
}

using QuadraticMass = Eigen::Matrix<double, Polynomial<2>::num_terms, Polynomial<2>::num_terms>;

/// Integrals of the products of the ten terms of Polynomial<2>.
QuadraticMass quadratic_mass(const QuarticMoments& moments);

/// Integrals of the ten terms times something, h(term), about another centre: add(term, integral); `d` as above.
template <class Term, class Add>
void shift_terms(const double d[3], const Term& h, const Add& add) {
  add(0, h(0));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    add(1 + i, h(1 + i) + d[i] * h(0));
    add(4 + i, h(4 + i) + 2 * d[i] * h(1 + i) + d[i] * d[i] * h(0));
    add(7 + i, h(7 + i) + d[i] * h(1 + j) + d[j] * h(1 + i) + d[i] * d[j] * h(0));
  }
}

}  // namespace cgcontact
