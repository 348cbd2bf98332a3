/// Lagrange elements of the unit cell (degree 1: trilinear, degree 2: triquadratic) and Gauss points.
/// Cell coordinates xi in [-1,1]^3; the nodes of an element lie on a lattice of degree + 1 per direction, node
/// a = i + n j + n^2 k with n = degree + 1 (degree 1: corner a = i + 2 j + 4 k); gradients are per cell unit (h = 1).
#pragma once

#include <Kokkos_Core.hpp>
#include <type_traits>

#include "kernels/mesh/dofs.hpp"

namespace cgcontact {

/// Three-point Gauss-Legendre rule on [-1,1].
struct Gauss3 {
  static constexpr int count = 3;
  static constexpr double point[3] = {-0.7745966692414833770, 0.0, 0.7745966692414833770};
  static constexpr double weight[3] = {0.5555555555555555556, 0.8888888888888888889, 0.5555555555555555556};
};

/// Five-point Gauss-Legendre rule on [-1,1].
struct Gauss5 {
  static constexpr int count = 5;
  static constexpr double point[5] = {-0.9061798459386639928, -0.5384693101056830910, 0.0, 0.5384693101056830910,
                                      0.9061798459386639928};
  static constexpr double weight[5] = {0.2369268850561890875, 0.4786286704993664680, 0.5688888888888888889,
                                       0.4786286704993664680, 0.2369268850561890875};
};

/// One dimension of an element: nodes at -1, ..., 1.
template <int degree>
struct LineElement {
  static_assert(degree == 1 || degree == 2);
  static constexpr int num_nodes = degree + 1;

  KOKKOS_INLINE_FUNCTION static void shape(double x, double l[num_nodes]) {
    if constexpr (degree == 1) {
      l[0] = 0.5 * (1 - x);
      l[1] = 0.5 * (1 + x);
    } else {
      l[0] = 0.5 * x * (x - 1);
      l[1] = (1 - x) * (1 + x);
      l[2] = 0.5 * x * (x + 1);
    }
  }

  /// Derivatives per cell unit: twice those with respect to x.
  KOKKOS_INLINE_FUNCTION static void derivative(double x, double d[num_nodes]) {
    if constexpr (degree == 1) {
      d[0] = -1;
      d[1] = 1;
    } else {
      d[0] = 2 * x - 1;
      d[1] = -4 * x;
      d[2] = 2 * x + 1;
    }
  }

  /// Integrals over a cell (length 1) of products of two shape functions.
  static constexpr double mass(int a, int b) {
    if constexpr (degree == 1) {
      return a == b ? 1. / 3 : 1. / 6;
    } else {
      constexpr double thirtieths[3][3] = {{4, 2, -1}, {2, 16, 2}, {-1, 2, 4}};
      return thirtieths[a][b] / 30;
    }
  }
};

template <int degree>
struct HexElement {
  static constexpr int nodes_per_line = degree + 1;
  static constexpr int nodes_per_face = nodes_per_line * nodes_per_line;
  static constexpr int num_nodes = nodes_per_line * nodes_per_face;
  static constexpr int num_dofs = dofs_per_node * num_nodes;
  /// Gauss rule whose points, with weights fitted to the moments of a cut cell, integrate the stiffness
  /// exactly: products of two gradients are of degree 2 * degree per variable.
  using Gauss = std::conditional_t<degree == 1, Gauss3, Gauss5>;

  /// Returns the index of a node along direction d, 0 .. degree.
  KOKKOS_INLINE_FUNCTION static constexpr int index_along(int node, int d) {
    return (d == 0 ? node : d == 1 ? node / nodes_per_line : node / nodes_per_face) % nodes_per_line;
  }
  KOKKOS_INLINE_FUNCTION static constexpr int node(int i, int j, int k) {
    return i + nodes_per_line * j + nodes_per_face * k;
  }

  /// Computes N[num_nodes] at xi.
  KOKKOS_INLINE_FUNCTION static void shape(const double xi[3], double N[num_nodes]) {
    double l[3][nodes_per_line];
    for (int d = 0; d < 3; ++d) LineElement<degree>::shape(xi[d], l[d]);
    for (int a = 0; a < num_nodes; ++a)
      N[a] = l[0][index_along(a, 0)] * l[1][index_along(a, 1)] * l[2][index_along(a, 2)];
  }

  /// Computes dN[num_nodes][3] at xi, derivatives with respect to grid coordinates (cell units).
  KOKKOS_INLINE_FUNCTION static void gradient(const double xi[3], double dN[num_nodes][3]) {
    double l[3][nodes_per_line], g[3][nodes_per_line];
    for (int d = 0; d < 3; ++d) {
      LineElement<degree>::shape(xi[d], l[d]);
      LineElement<degree>::derivative(xi[d], g[d]);
    }
    for (int a = 0; a < num_nodes; ++a) {
      const int i = index_along(a, 0), j = index_along(a, 1), k = index_along(a, 2);
      dN[a][0] = g[0][i] * l[1][j] * l[2][k];
      dN[a][1] = g[1][j] * l[0][i] * l[2][k];
      dN[a][2] = g[2][k] * l[0][i] * l[1][j];
    }
  }
};

/// Nodes of two cells that share a face: layers along its normal, each a face's lattice; node = layer * nodes_per_face
/// + tangential node. Layer `degree` lies on the face.
template <int degree>
struct GhostFace {
  static constexpr int num_layers = 2 * degree + 1;
  static constexpr int num_nodes = num_layers * HexElement<degree>::nodes_per_face;

  /// Returns the weight of a layer in the jump of the derivative of order 1 .. degree along the normal, per cell unit.
  static constexpr double jump(int order, int layer) {
    if constexpr (degree == 1) {
      constexpr double first[3] = {1, -2, 1};
      return first[layer];
    } else {
      constexpr double jumps[2][5] = {{1, -4, 6, -4, 1}, {4, -8, 0, 8, -4}};
      return jumps[order - 1][layer];
    }
  }
};

/// Evaluate the trilinear element, which everything but the plain operator uses: N[8] and dN[8][3] at xi.
KOKKOS_INLINE_FUNCTION void hex_shape(const double xi[3], double N[8]) { HexElement<1>::shape(xi, N); }
KOKKOS_INLINE_FUNCTION void hex_gradient(const double xi[3], double dN[8][3]) { HexElement<1>::gradient(xi, dN); }

/// Isotropic elasticity with unit Young's modulus: lambda, mu (Lame). In trilinear cells what lambda has beyond that of
/// nu = 0.4 resists the mean dilatation of the cell's part in the body only: at points it would lock them (Nagtegaal,
/// Parks, Rice, Comput. Methods Appl. Mech. Eng. 4 (1974); docs/theory.md, "Nearly incompressible materials").
struct UnitElasticity {
  double lambda = 0, mu = 0;
  double lambda_of_mean = 0;  ///< the part of lambda that acts on the mean dilatation
  UnitElasticity() = default;
  explicit UnitElasticity(double poisson_ratio)
      : lambda(poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))),
        mu(0.5 / (1 + poisson_ratio)),
        lambda_of_mean(lambda > 4 * mu ? lambda - 4 * mu : 0) {}
  KOKKOS_INLINE_FUNCTION double lambda_at_points() const { return lambda - lambda_of_mean; }
  /// Stress (xx, yy, zz, xy, yz, zx) of the displacement gradient g[i][j] = du_i/dx_j and the cell's mean dilatation.
  KOKKOS_INLINE_FUNCTION void stress(const double g[3][3], double mean_dilatation, double s[6]) const {
    const double trace = lambda_at_points() * (g[0][0] + g[1][1] + g[2][2]) + lambda_of_mean * mean_dilatation;
    s[0] = trace + 2 * mu * g[0][0];
    s[1] = trace + 2 * mu * g[1][1];
    s[2] = trace + 2 * mu * g[2][2];
    s[3] = mu * (g[0][1] + g[1][0]);
    s[4] = mu * (g[1][2] + g[2][1]);
    s[5] = mu * (g[2][0] + g[0][2]);
  }
};

}  // namespace cgcontact
