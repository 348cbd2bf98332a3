/// Trilinear shape functions of the unit cell and its Gauss points.
/// Cell coordinates xi in [-1,1]^3; corner a = i + 2 j + 4 k; gradients are per cell unit (h = 1).
#pragma once

#include <Kokkos_Core.hpp>

namespace cgcontact {

/// Three-point Gauss-Legendre rule on [-1,1].
struct Gauss3 {
  static constexpr double point[3] = {-0.7745966692414833770, 0.0, 0.7745966692414833770};
  static constexpr double weight[3] = {0.5555555555555555556, 0.8888888888888888889, 0.5555555555555555556};
};

/// Five-point Gauss-Legendre rule on [-1,1].
struct Gauss5 {
  static constexpr double point[5] = {-0.9061798459386639928, -0.5384693101056830910, 0.0, 0.5384693101056830910,
                                      0.9061798459386639928};
  static constexpr double weight[5] = {0.2369268850561890875, 0.4786286704993664680, 0.5688888888888888889,
                                       0.4786286704993664680, 0.2369268850561890875};
};

/// N[8] at xi.
KOKKOS_INLINE_FUNCTION void hex_shape(const double xi[3], double N[8]) {
  for (int a = 0; a < 8; ++a) {
    const double sx = (a & 1) ? 1 : -1, sy = (a & 2) ? 1 : -1, sz = (a & 4) ? 1 : -1;
    N[a] = 0.125 * (1 + sx * xi[0]) * (1 + sy * xi[1]) * (1 + sz * xi[2]);
  }
}

/// dN[8][3] at xi, derivatives with respect to grid coordinates (cell units).
KOKKOS_INLINE_FUNCTION void hex_gradient(const double xi[3], double dN[8][3]) {
  for (int a = 0; a < 8; ++a) {
    const double sx = (a & 1) ? 1 : -1, sy = (a & 2) ? 1 : -1, sz = (a & 4) ? 1 : -1;
    const double fx = 1 + sx * xi[0], fy = 1 + sy * xi[1], fz = 1 + sz * xi[2];
    dN[a][0] = 0.25 * sx * fy * fz;
    dN[a][1] = 0.25 * sy * fx * fz;
    dN[a][2] = 0.25 * sz * fx * fy;
  }
}

/// Isotropic elasticity with unit Young's modulus: lambda, mu (Lame).
struct UnitElasticity {
  double lambda = 0, mu = 0;
  UnitElasticity() = default;
  explicit UnitElasticity(double poisson_ratio)
      : lambda(poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))), mu(0.5 / (1 + poisson_ratio)) {}
  /// Stress (xx, yy, zz, xy, yz, zx) of the displacement gradient g[i][j] = du_i/dx_j.
  KOKKOS_INLINE_FUNCTION void stress(const double g[3][3], double s[6]) const {
    const double trace = lambda * (g[0][0] + g[1][1] + g[2][2]);
    s[0] = trace + 2 * mu * g[0][0];
    s[1] = trace + 2 * mu * g[1][1];
    s[2] = trace + 2 * mu * g[2][2];
    s[3] = mu * (g[0][1] + g[1][0]);
    s[4] = mu * (g[1][2] + g[2][1]);
    s[5] = mu * (g[2][0] + g[0][2]);
  }
};

/// Stress at xi from the 24 corner displacements u[8][3] (per cell unit).
KOKKOS_INLINE_FUNCTION void hex_stress(const UnitElasticity& law, const double u[8][3], const double xi[3],
                                       double s[6]) {
  double dN[8][3], g[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  hex_gradient(xi, dN);
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) g[i][j] += u[a][i] * dN[a][j];
  law.stress(g, s);
}

}  // namespace cgcontact
