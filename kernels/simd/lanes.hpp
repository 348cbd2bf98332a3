/// 64-byte SIMD vectors ("lanes") for the fast kernels: GCC vector extensions, so the arithmetic is plain C++ and one
/// lane computes what a scalar loop would.
#pragma once

#include <cstdint>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace cgcontact {

// Without AVX-512 g++ says that passing these vectors has no fixed ABI, at the end of the file: no pop. They never
// leave a file.
#pragma GCC diagnostic ignored "-Wpsabi"

template <class Real>
struct Lanes;

template <>
struct Lanes<double> {
  static constexpr int count = 8;
  typedef double Vector __attribute__((vector_size(64)));
  typedef double Unaligned __attribute__((vector_size(64), aligned(8), may_alias));
  typedef std::int64_t Mask __attribute__((vector_size(64)));
  using Integer = std::int64_t;
};

template <>
struct Lanes<float> {
  static constexpr int count = 16;
  typedef float Vector __attribute__((vector_size(64)));
  typedef float Unaligned __attribute__((vector_size(64), aligned(4), may_alias));
  typedef std::int32_t Mask __attribute__((vector_size(64)));
  using Integer = std::int32_t;
};

template <class Real>
using Vector = typename Lanes<Real>::Vector;

template <class Real>
inline Vector<Real> load(const Real* p) {
  return *reinterpret_cast<const typename Lanes<Real>::Unaligned*>(p);
}

template <class Real>
inline void store(Real* p, const Vector<Real>& v) {
  *reinterpret_cast<typename Lanes<Real>::Unaligned*>(p) = v;
}

/// Loads the first n entries (0 <= n <= count); the others are zero and not read.
template <class Real>
inline Vector<Real> load_first(const Real* p, int n) {
#ifdef __AVX512F__
  if constexpr (sizeof(Real) == 8)
    return _mm512_maskz_loadu_pd(static_cast<__mmask8>((1u << n) - 1), p);
  else
    return _mm512_maskz_loadu_ps(static_cast<__mmask16>((1u << n) - 1), p);
#else
  Vector<Real> v = {};
  for (int i = 0; i < n; ++i) v[i] = p[i];
  return v;
#endif
}

/// Writes the first n entries only.
template <class Real>
inline void store_first(Real* p, const Vector<Real>& v, int n) {
#ifdef __AVX512F__
  if constexpr (sizeof(Real) == 8)
    _mm512_mask_storeu_pd(p, static_cast<__mmask8>((1u << n) - 1), v);
  else
    _mm512_mask_storeu_ps(p, static_cast<__mmask16>((1u << n) - 1), v);
#else
  for (int i = 0; i < n; ++i) p[i] = v[i];
#endif
}

/// Eight entries whatever the precision, for two nodes at a time.
template <class Real>
struct EightOf;
template <>
struct EightOf<double> {
  typedef double Type __attribute__((vector_size(64)));
};
template <>
struct EightOf<float> {
  typedef float Type __attribute__((vector_size(32)));
};
template <class Real>
using Eight = typename EightOf<Real>::Type;

/// Loads the first six entries; nothing behind them is read.
template <class Real>
inline Eight<Real> load_six(const Real* p) {
#ifdef __AVX512VL__
  if constexpr (sizeof(Real) == 8)
    return _mm512_maskz_loadu_pd(0x3f, p);
  else
    return _mm256_maskz_loadu_ps(0x3f, p);
#else
  return Eight<Real>{p[0], p[1], p[2], p[3], p[4], p[5], 0, 0};
#endif
}

/// Loads a[0..2], 0, b[0..2], 0.
template <class Real>
inline Eight<Real> load_three_and_three(const Real* a, const Real* b) {
#ifdef __AVX512VL__
  if constexpr (sizeof(Real) == 8)
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_maskz_loadu_pd(7, a)), _mm256_maskz_loadu_pd(7, b), 1);
  else
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_maskz_loadu_ps(7, a)), _mm_maskz_loadu_ps(7, b), 1);
#else
  return Eight<Real>{a[0], a[1], a[2], 0, b[0], b[1], b[2], 0};
#endif
}

template <class Real>
struct ShortVectors {
  typedef Real Four __attribute__((vector_size(4 * sizeof(Real)), aligned(sizeof(Real)), may_alias));
  typedef Real Two __attribute__((vector_size(2 * sizeof(Real)), aligned(sizeof(Real)), may_alias));
};

/// Adds or subtracts the six entries at v; in chunks of four and two, because loads wait for earlier masked stores
/// nearby (a quarter of the time of the cut cells).
template <bool subtract, class Real>
inline void add_six(Real* to, const Real* v) {
  using Four = typename ShortVectors<Real>::Four;
  using Two = typename ShortVectors<Real>::Two;
  const Four four = *reinterpret_cast<const Four*>(v);
  const Two two = *reinterpret_cast<const Two*>(v + 4);
  if (subtract) {
    *reinterpret_cast<Four*>(to) -= four;
    *reinterpret_cast<Two*>(to + 4) -= two;
  } else {
    *reinterpret_cast<Four*>(to) += four;
    *reinterpret_cast<Two*>(to + 4) += two;
  }
}

template <class Real>
inline void add_eight(Real* to, const Real* v) {
  using Four = typename ShortVectors<Real>::Four;
  *reinterpret_cast<Four*>(to) += *reinterpret_cast<const Four*>(v);
  *reinterpret_cast<Four*>(to + 4) += *reinterpret_cast<const Four*>(v + 4);
}

template <class Real>
inline void add_three(Real* to, const Real* v) {
  using Two = typename ShortVectors<Real>::Two;
  *reinterpret_cast<Two*>(to) += *reinterpret_cast<const Two*>(v);
  to[2] += v[2];
}

namespace detail {

/// Shuffles: lane i is number indices[i] in a, then b.
template <class V, class M>
inline V shuffle(const V& a, const V& b, const M& indices) {
#ifdef __clang__
  constexpr int count = sizeof(M) / sizeof(indices[0]);
  V v = {};
  for (int i = 0; i < count; ++i) v[i] = indices[i] < count ? a[indices[i]] : b[indices[i] - count];
  return v;
#else
  return __builtin_shuffle(a, b, indices);
#endif
}

/// Index tables of (de)interleaving three components; constant data.
template <class Real>
struct Interleave {
  static constexpr int L = Lanes<Real>::count;
  using Integer = typename Lanes<Real>::Integer;
  alignas(64) Integer split_low[3][L] = {}, split_high[3][L] = {};  // component <- (v0, v1), (that, v2)
  alignas(64) Integer join_low[3][L] = {}, join_high[3][L] = {};    // output vector <- (x, y), (that, z)
  constexpr Interleave() {
    for (int c = 0; c < 3; ++c)
      for (int l = 0; l < L; ++l) {
        const int source = 3 * l + c;
        split_low[c][l] = source < 2 * L ? source : 0;
        split_high[c][l] = source < 2 * L ? l : source - 2 * L + L;
        const int flat = c * L + l, node = flat / 3, component = flat % 3;
        join_low[c][l] = component == 2 ? 0 : component * L + node;
        join_high[c][l] = component == 2 ? L + node : l;
      }
  }
};
template <class Real>
inline constexpr Interleave<Real> interleave{};

/// 8 x 8 transposition in every group of 8 lanes, as three butterfly stages.
template <class Real>
struct Butterfly {
  static constexpr int L = Lanes<Real>::count;
  using Integer = typename Lanes<Real>::Integer;
  alignas(64) Integer low[3][L] = {}, high[3][L] = {};
  constexpr Butterfly() {
    for (int s = 0; s < 3; ++s)
      for (int l = 0; l < L; ++l) {
        const int d = 1 << s;
        low[s][l] = (l & d) ? L + l - d : l;
        high[s][l] = (l & d) ? L + l : l + d;
      }
  }
};
template <class Real>
inline constexpr Butterfly<Real> butterfly{};

template <class Real>
inline typename Lanes<Real>::Mask mask(const typename Lanes<Real>::Integer* p) {
  return *reinterpret_cast<const typename Lanes<Real>::Mask*>(p);
}

}  // namespace detail

/// Splits three vectors of interleaved components into one vector per component.
template <class Real>
inline void split_components(const Vector<Real> v[3], Vector<Real> u[3]) {
  constexpr const auto& t = detail::interleave<Real>;
  for (int c = 0; c < 3; ++c)
    u[c] = detail::shuffle(detail::shuffle(v[0], v[1], detail::mask<Real>(t.split_low[c])), v[2],
                           detail::mask<Real>(t.split_high[c]));
}

/// Joins one vector per component to three vectors of interleaved components.
template <class Real>
inline void join_components(const Vector<Real> u[3], Vector<Real> v[3]) {
  constexpr const auto& t = detail::interleave<Real>;
  for (int c = 0; c < 3; ++c)
    v[c] = detail::shuffle(detail::shuffle(u[0], u[1], detail::mask<Real>(t.join_low[c])), u[2],
                           detail::mask<Real>(t.join_high[c]));
}

/// Transposes: r[i] lane l <-> r[l % 8] lane i (+ 8 in the upper half): its own inverse.
template <class Real>
inline void transpose8(Vector<Real> r[8]) {
  constexpr const auto& t = detail::butterfly<Real>;
  for (int s = 0; s < 3; ++s)
    for (int i = 0; i < 8; ++i) {
      if (i >> s & 1) continue;
      const int j = i + (1 << s);
      const Vector<Real> a = r[i], b = r[j];
      r[i] = detail::shuffle(a, b, detail::mask<Real>(t.low[s]));
      r[j] = detail::shuffle(a, b, detail::mask<Real>(t.high[s]));
    }
}

/// Joins the lower eight lanes of a and b (float only).
inline Vector<float> join_halves(const Vector<float>& a, const Vector<float>& b) {
  constexpr Lanes<float>::Mask halves = {0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23};
  return detail::shuffle(a, b, halves);
}

}  // namespace cgcontact
