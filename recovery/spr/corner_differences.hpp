/// The displacement gradient of a trilinear cell as a polynomial about its centre, cell units. With h from
/// corner_differences, du_i/dx_j = sum over the four terms of corner_scale(term) h[corner_difference(j, term)][i] times
/// 1, the other two coordinates, and their product.
#pragma once

#include <Kokkos_Macros.hpp>

namespace cgcontact {

KOKKOS_FORCEINLINE_FUNCTION constexpr int corner_difference(int j, int term) {
  constexpr int difference[3][4] = {{1, 3, 5, 7}, {2, 3, 6, 7}, {4, 5, 6, 7}};
  return difference[j][term];
}
KOKKOS_FORCEINLINE_FUNCTION constexpr double corner_scale(int term) {
  constexpr double scale[4] = {0.25, 0.5, 0.5, 1};
  return scale[term];
}

/// In place, corner values (corner, component) -> sums and differences over each direction (bit set: difference):
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

}  // namespace cgcontact
