/// Displacement gradient of a trilinear cell as a polynomial about its centre, cell units. With h from
/// corner_differences, du_i/dx_j = sum over the four terms of corner_scale(term) h[corner_difference(j, term)][i] times
/// 1, the other two coordinates, and their product.
#pragma once

#include "kernels/mesh/interpolate.hpp"

namespace cgcontact {

KOKKOS_FORCEINLINE_FUNCTION constexpr int corner_difference(int j, int term) {
  constexpr int difference[3][4] = {{1, 3, 5, 7}, {2, 3, 6, 7}, {4, 5, 6, 7}};
  return difference[j][term];
}
KOKKOS_FORCEINLINE_FUNCTION constexpr double corner_scale(int term) {
  constexpr double scale[4] = {0.25, 0.5, 0.5, 1};
  return scale[term];
}

/// Turns in place corner values (corner, component) -> sums and differences over each direction (bit set: difference):
/// u = sum over the corners = products of (1/2 -+ x), so that du/dx = h1/4 + h3/2 y + h5/2 z + h7 yz, and cyclic.
KOKKOS_INLINE_FUNCTION void corner_differences(double h[8][3]) {
  for (int bit = 1; bit < 8; bit *= 2)
    for (int a = 0; a < 8; ++a)
      if (!(a & bit))
        for (int i = 0; i < 3; ++i) {
          const double low = h[a][i], high = h[a | bit][i];
          h[a][i] = high + low;
          h[a | bit][i] = high - low;
        }
}

/// Computes c: the strain u_r / r around the axis of a body of revolution (per cell unit) is the slope of u_r along r
/// and c[0] + c[1] and c[2] times the two coordinates beside the one across + c[3] times their product. What is over r
/// is taken as linear between the two Gauss points; it is u_r extrapolated to the axis, and zero in cells beside it.
KOKKOS_INLINE_FUNCTION void ring_differences(const Ring& ring, const double h[8][3], double c[4]) {
  const int along = 3 - ring.across - ring.radial, G = 1 << ring.radial, E = 1 << along;
  const double q = ring.diameter, mean = h[0][ring.radial] - q * h[G][ring.radial],
               slope = h[E][ring.radial] - q * h[G | E][ring.radial];
  const double scale = 1 / (q * q - 1. / 3), inverse[2] = {q * scale, -scale};
  const bool radial_first = ring.radial < along;
  c[0] = 0.25 * mean * inverse[0];
  c[radial_first ? 1 : 2] = 0.5 * mean * inverse[1];
  c[radial_first ? 2 : 1] = 0.5 * slope * inverse[0];
  c[3] = slope * inverse[1];
}

}  // namespace cgcontact
