/// Integrals of all monomials up to degree 4 over the material in cells, for the mass matrices of quadratic
/// polynomials.
#pragma once

#include <array>

#include "core/cells/cut_cells.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact {

/// Returns the index of x^i y^j z^k, i + j + k <= 4, among the 35 monomials: by i, then j + k, then k. The monomials of
/// each i come in the order of those of i = 0.
KOKKOS_FORCEINLINE_FUNCTION constexpr int quartic_index(int i, int j, int k) {
  constexpr int first[5] = {0, 15, 25, 31, 34};  // of each i
  return first[i] + (j + k) * (j + k + 1) / 2 + k;
}
constexpr int num_quartics = 35;

/// Integrals of the monomials about some centre, cell units (a full cell has volume 1).
using QuarticMoments = std::array<double, num_quartics>;

/// Returns those over the material in a cell, about the cell's centre.
QuarticMoments quartic_moments(const Moments& moments);

/// Returns the index of the product of two terms of Polynomial<2> among the monomials.
KOKKOS_FORCEINLINE_FUNCTION constexpr int index_of_product(int s, int t) {
  constexpr int power[10][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};
  return quartic_index(power[s][0] + power[t][0], power[s][1] + power[t][1], power[s][2] + power[t][2]);
}

using QuadraticMass = Eigen::Matrix<double, Polynomial<2>::num_terms, Polynomial<2>::num_terms>;

/// Integrals of the products of the ten terms of Polynomial<2>; moments: num_quartics.
QuadraticMass quadratic_mass(const double* moments);

}  // namespace cgcontact
