/// Operations beyond + - * / for arithmetic written once for one patch (`double`) and for eight at a time
/// (`Vector<double>`, one per lane): selection instead of branches, roots, and the way in and out of memory.
#pragma once

#include <Kokkos_Core.hpp>
#include <cmath>

#include "kernels/simd/lanes.hpp"

namespace cgcontact {

/// Number of patches that one `Real` holds, and the type of a comparison.
template <class Real>
struct LaneTraits {
  static constexpr int count = Lanes<double>::count;
  using Mask = Lanes<double>::Mask;
};
template <>
struct LaneTraits<double> {
  static constexpr int count = 1;
  using Mask = bool;
};
template <class Real>
using MaskOf = typename LaneTraits<Real>::Mask;

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real select(const MaskOf<Real>& condition, const Real& yes, const Real& no) {
  return condition ? yes : no;
}

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real larger(const Real& a, const Real& b) {
  return a > b ? a : b;
}

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real magnitude(const Real& a) {
  return larger<Real>(a, -a);
}

KOKKOS_FORCEINLINE_FUNCTION double square_root(double a) { return sqrt(a); }
inline Vector<double> square_root(const Vector<double>& a) {
#ifdef __AVX512F__
  return _mm512_sqrt_pd(a);
#else
  Vector<double> root;
  for (int l = 0; l < Lanes<double>::count; ++l) root[l] = std::sqrt(a[l]);
  return root;
#endif
}

KOKKOS_FORCEINLINE_FUNCTION bool any(bool m) { return m; }
inline bool any(const Lanes<double>::Mask& m) {
  std::int64_t sum = 0;
  for (int l = 0; l < Lanes<double>::count; ++l) sum |= m[l];
  return sum != 0;
}

/// Returns one lane's number.
KOKKOS_FORCEINLINE_FUNCTION double lane(double a, int) { return a; }
inline double lane(const Vector<double>& a, int l) { return a[l]; }
KOKKOS_FORCEINLINE_FUNCTION bool lane(bool m, int) { return m; }
inline bool lane(const Lanes<double>::Mask& m, int l) { return m[l] != 0; }
KOKKOS_FORCEINLINE_FUNCTION void set_lane(double& a, int, double value) { a = value; }
inline void set_lane(Vector<double>& a, int l, double value) { a[l] = value; }

/// out[i] lane l <- from[l][i], i < n.
KOKKOS_FORCEINLINE_FUNCTION void gather(const double* const from[1], int n, double* out) {
  for (int i = 0; i < n; ++i) out[i] = from[0][i];
}
inline void gather(const double* const from[8], int n, Vector<double>* out) {
  for (int i = 0; i < n; i += 8) {
    const int m = n - i < 8 ? n - i : 8;
    Vector<double> block[8];
    for (int l = 0; l < 8; ++l) block[l] = m == 8 ? load(from[l] + i) : load_first(from[l] + i, m);
    transpose8<double>(block);
    for (int j = 0; j < m; ++j) out[i + j] = block[j];
  }
}

/// to[l][i] <- values[i] lane l, i < n; lanes without an address (nullptr) are left out.
KOKKOS_FORCEINLINE_FUNCTION void scatter(const double* values, int n, double* const to[1]) {
  if (to[0])
    for (int i = 0; i < n; ++i) to[0][i] = values[i];
}
inline void scatter(const Vector<double>* values, int n, double* const to[8]) {
  for (int i = 0; i < n; i += 8) {
    const int m = n - i < 8 ? n - i : 8;
    Vector<double> block[8] = {};
    for (int j = 0; j < m; ++j) block[j] = values[i + j];
    transpose8<double>(block);
    for (int l = 0; l < 8; ++l)
      if (to[l]) store_first<double>(to[l] + i, block[l], m);
  }
}

}  // namespace cgcontact
