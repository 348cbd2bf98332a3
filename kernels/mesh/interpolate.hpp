/// Nodal field in one cell: its values at the corners, at a point, its gradient, its stress, and the row of a
/// displacement at a point. Trilinear element; xi: cell coordinates, gradients per cell unit.
#pragma once

#include <array>

#include "core/base/numbers/types.hpp"
#include "kernels/mesh/hex.hpp"

namespace cgcontact {

/// Gathers values at the corners: out[corner][component]. u: vector of all nodes, called with the number of a DoF.
template <class Nodes, class U>
KOKKOS_INLINE_FUNCTION void corner_values(const Nodes& nodes, const U& u, double out[8][3]) {
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) out[a][i] = u(dof_of(nodes[a], i));
}

/// Returns start + sum of N_a u_a.
inline Vec3 interpolate(const double u[8][3], const Vec3& xi, Vec3 start = Vec3::Zero()) {
  double N[8];
  hex_shape(xi.data(), N);
  for (int a = 0; a < 8; ++a) start += N[a] * Vec3(u[a][0], u[a][1], u[a][2]);
  return start;
}

/// Computes g[i][j] = du_i / dx_j.
KOKKOS_INLINE_FUNCTION void interpolate_gradient(const double u[8][3], const double xi[3], double g[3][3]) {
  double dN[8][3];
  hex_gradient(xi, dN);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g[i][j] = 0;
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) g[i][j] += u[a][i] * dN[a][j];
}

/// Cell of a body of revolution; none elsewhere.
struct Ring {
  int across = -1, radial = -1;  ///< axes of the grid
  double diameter = 0;           ///< BodyMesh::diameter_of
};

/// Adds the strain u_r / r around the axis of revolution, per cell unit, to the gradient: nothing else varies across.
/// On the axis it is the slope of u_r.
KOKKOS_INLINE_FUNCTION void add_ring_strain(const Ring& ring, const double u[8][3], const double xi[3],
                                            double g[3][3]) {
  if (ring.across < 0) return;
  constexpr double on_axis = 1e-6;
  double N[8], u_r = 0;
  hex_shape(xi, N);
  for (int a = 0; a < 8; ++a) u_r += N[a] * u[a][ring.radial];
  const double diameter = ring.diameter + xi[ring.radial];
  g[ring.across][ring.across] = diameter > on_axis ? 2 * u_r / diameter : g[ring.radial][ring.radial];
}

/// Stress from the corner displacements (per cell unit, unit Young's modulus): xx, yy, zz, xy, yz, zx.
KOKKOS_INLINE_FUNCTION void hex_stress(const UnitElasticity& law, const double u[8][3], double mean_dilatation,
                                       const double xi[3], double s[6], const Ring& ring = {}) {
  double g[3][3];
  interpolate_gradient(u, xi, g);
  add_ring_strain(ring, u, xi, g);
  law.stress(g, mean_dilatation, s);
}

/// Calls use(DoF, coefficient) for the row (24 entries) of the displacement at a point along a direction (grid axes).
/// The same coefficients spread a force along the direction over the nodes.
template <class Use>
void displacement_row(const std::array<int, 8>& nodes, const Vec3& xi, const Vec3& direction, const Use& use) {
  double N[8];
  hex_shape(xi.data(), N);
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) use(dof_of(nodes[a], i), N[a] * direction[i]);
}

}  // namespace cgcontact
