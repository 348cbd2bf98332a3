/// Small symmetric systems, one per lane: packed Cholesky, and the truncated pseudo-inverse applied to a vector.
/// Matrices are lower triangles by rows, entry (r, s) at row(r)[s]. No lane's result depends on the others': a lane
/// that is done, or has fewer rows, gets rotations and rows that change nothing.
#pragma once

#include "kernels/simd/lane_math.hpp"

namespace cgcontact {

/// Rows come in blocks of this many (those added: 1 on the diagonal, else 0).
constexpr int row_block = 4;

KOKKOS_FORCEINLINE_FUNCTION constexpr int packed_row(int r) { return r * (r + 1) / 2; }

/// Subtracts earlier columns from a block: acc[i][j] = A(r+i, s+j) - sum_k L(r+i, k) L(s+j, k).
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void cholesky_block(const Real* A, const Real* L, int r, int s, Real acc[4][4]) {
  const Real* a[4];
  const Real* b[4];
  for (int i = 0; i < 4; ++i) a[i] = L + packed_row(r + i), b[i] = L + packed_row(s + i);
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) acc[i][j] = r > s || j <= i ? A[packed_row(r + i) + s + j] : Real{};
  for (int k = 0; k < s; ++k)
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i)
#pragma GCC unroll 4
      for (int j = 0; j < 4; ++j) acc[i][j] -= a[i][k] * b[j][k];
}

/// Factorises A - shift I = L L^T, n rows (a multiple of row_block); the diagonal of L holds reciprocals. n^3 / 3 flop.
/// True for the lanes whose matrix is positive definite; the other factors are unusable.
template <class Real>
KOKKOS_INLINE_FUNCTION MaskOf<Real> packed_cholesky(const Real* A, const Real& shift, int n, Real* L) {
  MaskOf<Real> positive = shift == shift;
  for (int r = 0; r < n; r += 4) {
    Real acc[4][4];
    for (int s = 0; s < r; s += 4) {
      cholesky_block(A, L, r, s, acc);
#pragma GCC unroll 4
      for (int j = 0; j < 4; ++j) {
        const Real* d = L + packed_row(s + j) + s;
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) {
#pragma GCC unroll 4
          for (int k = 0; k < j; ++k) acc[i][j] -= acc[i][k] * d[k];
          acc[i][j] *= d[j];
          L[packed_row(r + i) + s + j] = acc[i][j];
        }
      }
    }
    cholesky_block(A, L, r, r, acc);
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      Real pivot = acc[j][j] - shift;
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) pivot -= acc[j][k] * acc[j][k];
      const MaskOf<Real> good = pivot > 1e-300;
      positive = positive & good;
      const Real inverse = 1.0 / square_root(select<Real>(good, pivot, Real{} + 1));
      L[packed_row(r + j) + r + j] = inverse;
#pragma GCC unroll 4
      for (int i = j + 1; i < 4; ++i) {
#pragma GCC unroll 4
        for (int k = 0; k < j; ++k) acc[i][j] -= acc[i][k] * acc[j][k];
        acc[i][j] *= inverse;
        L[packed_row(r + i) + r + j] = acc[i][j];
      }
    }
    if (!any(positive)) break;
  }
  return positive;
}

/// x <- (L L^T)^-1 x. 2 n^2 flop.
template <class Real>
KOKKOS_INLINE_FUNCTION void packed_cholesky_solve(const Real* L, int n, Real* x) {
  for (int c = 0; c < n; ++c) {
    const Real value = x[c] *= L[packed_row(c) + c];
    for (int r = c + 1; r < n; ++r) x[r] -= L[packed_row(r) + c] * value;
  }
  for (int r = n - 1; r >= 0; --r) {
    const Real value = x[r] *= L[packed_row(r) + r];
    for (int c = 0; c < r; ++c) x[c] -= L[packed_row(r) + c] * value;
  }
}

/// Work space of pseudo_inverse_solve, numbers per lane.
struct SpectralScratch {
  /// Return bounds: QR takes less than two sweeps for an eigenvalue; the slowest lane counts.
  static constexpr int max_sweeps(int n) { return 6 * n + 20; }
  static constexpr int max_rotations(int n) { return n * (2 * n + 20); }
  static constexpr std::size_t size(int n) { return 7 * n + 2 * max_sweeps(n) + 2 * max_rotations(n); }
};

/// Makes the reflector H = 1 - factor v v^T that takes rows k+1 .. of column k of A to their length: v into the column,
/// and v with zeros around it into v[]; e: the image's first entry.
template <class Real>
KOKKOS_INLINE_FUNCTION void make_reflector(Real* A, int n, int k, Real* v, Real& factor, Real& e) {
  Real squares = Real{};
  for (int i = k + 1; i < n; ++i) {
    v[i] = A[packed_row(i) + k];
    squares += v[i] * v[i];
  }
  const MaskOf<Real> some = squares > 1e-280;
  const Real first = v[k + 1], norm = square_root(squares);
  const Real image = select<Real>(first > 0, -norm, norm);
  v[k + 1] = A[packed_row(k + 1) + k] = first - image;
  const Real half = squares - first * image;  // v.v / 2
  factor = select<Real>(some, 1.0 / select<Real>(some, half, Real{} + 1), Real{});
  e = select<Real>(some, image, Real{});
}

/// Updates A <- A - v w^T - w v^T in some rows from i on, columns from `first` on, and what they add to product = A
/// next: several rows at a time, since loading the vectors would outlast the arithmetic.
template <int rows, class Real>
KOKKOS_INLINE_FUNCTION void update_rows(Real* A, int i, int first, const Real* v, const Real* w, const Real* next,
                                        Real* product) {
  Real vi[rows], wi[rows], ni[rows], sum[rows];
  Real* row[rows];
#pragma GCC unroll 4
  for (int r = 0; r < rows; ++r) {
    vi[r] = v[i + r], wi[r] = w[i + r], ni[r] = next[i + r], sum[r] = Real{};
    row[r] = A + packed_row(i + r);
  }
  for (int j = first; j < i; ++j) {
    const Real vj = v[j], wj = w[j], nj = next[j];
    Real column = product[j];
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r) {
      const Real updated = row[r][j] = row[r][j] - (vi[r] * wj + wi[r] * vj);
      sum[r] += updated * nj;
      column += updated * ni[r];
    }
    product[j] = column;
  }
  for (int r = 0; r < rows; ++r) {
    for (int j = i; j < i + r; ++j) {
      const Real updated = row[r][j] = row[r][j] - (vi[r] * w[j] + wi[r] * v[j]);
      sum[r] += updated * next[j];
      product[j] += updated * ni[r];
    }
    row[r][i + r] -= 2.0 * vi[r] * wi[r];
    product[i + r] += sum[r] + row[r][i + r] * ni[r];
  }
}

/// Reduces A to a tridiagonal matrix (Householder): A <- the reflectors (column k, below the diagonal), d, e, factor; x
/// <- Q^T x. work: 4 n numbers. The update after one reflector and the product with the next one, which needs one
/// updated column only, share one pass over the matrix. 4/3 n^3 flop.
template <class Real>
KOKKOS_INLINE_FUNCTION void tridiagonalise(Real* A, int n, Real* d, Real* e, Real* factor, Real* work, Real* x) {
  Real *v = work, *w = v + n, *next = w + n, *product = next + n;
  make_reflector(A, n, 0, v, factor[0], e[0]);
  for (int i = 1; i < n; ++i) product[i] = Real{};
  for (int i = 1; i < n; ++i) {
    const Real* row = A + packed_row(i);
    Real sum = row[i] * v[i];
    for (int j = 1; j < i; ++j) {
      sum += row[j] * v[j];
      product[j] += row[j] * v[i];
    }
    product[i] += sum;
  }
  for (int k = 0;; ++k) {
    // A <- H A H = A - v w^T - w v^T in the rows from k + 1, with product = A v.
    Real along = Real{}, inner = Real{};
    for (int i = k + 1; i < n; ++i) {
      along += v[i] * x[i];
      inner += v[i] * product[i];
    }
    along *= factor[k];
    inner *= 0.5 * factor[k] * factor[k];
    for (int i = k + 1; i < n; ++i) {
      w[i] = factor[k] * product[i] - inner * v[i];
      x[i] -= along * v[i];
    }
    const int c = k + 1;
    for (int i = c; i < n; ++i) A[packed_row(i) + c] -= v[i] * w[c] + w[i] * v[c];
    if (c + 1 == n) break;
    make_reflector(A, n, c, next, factor[c], e[c]);
    for (int i = c + 1; i < n; ++i) product[i] = Real{};
    int i = c + 1;
    for (; i + 4 <= n; i += 4) update_rows<4>(A, i, c + 1, v, w, next, product);
    for (; i < n; ++i) update_rows<1>(A, i, c + 1, v, w, next, product);
    Real* const used = v;
    v = next, next = used;
  }
  for (int k = 0; k < n; ++k) d[k] = A[packed_row(k) + k];
}

/// The last block of a tridiagonal matrix that has not split and has an eigenvalue up to the threshold, per lane: rows
/// low .. high (high 0: none is left), and the shift of its next step.
template <class Real>
struct ActiveBlock {
  Real low, high, shift;
};

/// Sets off-diagonal entries below `small` to zero and finds a block. Its pivots count the eigenvalues below the
/// threshold, from the last row upwards (Sylvester's law of inertia). The shift: the lower eigenvalue of the block's
/// last two rows once it belongs to one of those, 0 before, which brings the least ones there. Where that takes too
/// long (nearly equal eigenvalues around the threshold): Wilkinson's, which splits off any.
template <class Real>
KOKKOS_INLINE_FUNCTION ActiveBlock<Real> find_block(const Real* d, Real* e, int rows, const Real& small,
                                                    const Real& threshold, const MaskOf<Real>& slow) {
  const Real zero = Real{}, one = Real{} + 1;
  ActiveBlock<Real> block{zero, zero, zero};
  const MaskOf<Real> none = zero != zero;
  MaskOf<Real> inside = none, wanted = none, closed = none;
  Real a = zero, b = zero, c = zero;  // of the last two rows: [a b; b c]
  Real pivot = zero;
  for (int k = rows - 2; k >= 0; --k) {
    const MaskOf<Real> coupled = magnitude(e[k]) > small;
    e[k] = select<Real>(coupled, e[k], zero);
    closed = closed | (inside & !coupled & wanted);
    const MaskOf<Real> starts = coupled & !inside & !closed;
    inside = coupled & !closed;
    block.high = select<Real>(starts, zero + (k + 1), block.high);
    block.low = select<Real>(inside, zero + k, block.low);
    a = select<Real>(starts, d[k], a), b = select<Real>(starts, e[k], b), c = select<Real>(starts, d[k + 1], c);
    const Real last = d[k + 1] - threshold;
    pivot = select<Real>(starts, last, pivot);
    wanted = (wanted & !starts) | (starts & !(last > 0));
    pivot = d[k] - threshold - e[k] * e[k] / select<Real>(pivot == zero, one * 1e-300, pivot);
    wanted = wanted | (inside & !(pivot > 0));
  }
  closed = closed | (inside & wanted);
  block.high = select<Real>(closed, block.high, zero);
  const Real delta = 0.5 * magnitude<Real>(a - c);
  const Real reach = delta + square_root(delta * delta + b * b), push = b * b / select<Real>(closed, reach, one);
  const Real lower = select<Real>(a < c, a, c) - push, nearest = select<Real>(a < c, c + push, c - push);
  block.shift = select<Real>(closed & (slow | (lower < threshold)), select<Real>(slow, nearest, lower), zero);
  return block;
}

/// Bounds the largest eigenvalue of a tridiagonal matrix from above, to 1e-10 of it, by bisection into five intervals.
/// upper: a bound.
template <class Real>
KOKKOS_INLINE_FUNCTION Real largest_eigenvalue(const Real* d, const Real* e, int n, Real upper) {
  constexpr int intervals = 5, rounds = 14;  // 5^-14 = 2e-10 of upper - lower, which is less than upper / 2
  const Real tiny = Real{} + 1e-300;
  Real lower = d[0];
  for (int k = 1; k < n; ++k) lower = larger<Real>(lower, d[k]);
  for (int round = 0; round < rounds; ++round) {
    const Real step = (upper - lower) / intervals;
    Real at[intervals - 1], pivot[intervals - 1];
    MaskOf<Real> above[intervals - 1];  // all eigenvalues lie below
    for (int i = 0; i + 1 < intervals; ++i) {
      at[i] = lower + (i + 1.0) * step;
      pivot[i] = at[i] - d[0];
      above[i] = pivot[i] > 0;
    }
    for (int k = 1; k < n; ++k)
#pragma GCC unroll 4
      for (int i = 0; i + 1 < intervals; ++i) {
        pivot[i] = at[i] - d[k] - e[k - 1] * e[k - 1] / select<Real>(pivot[i] > 0, pivot[i], tiny);
        above[i] = above[i] & (pivot[i] > 0);
      }
    Real low = lower, high = upper;
    for (int i = 0; i + 1 < intervals; ++i) low = select<Real>(above[i], low, at[i]);
    for (int i = intervals - 2; i >= 0; --i) high = select<Real>(above[i], at[i], high);
    lower = low, upper = high;
  }
  return upper;
}

/// Log of split_off(), to undo it: sweep i turned rows ranges[2 i] .. ranges[2 i + 1], one rotation (cosine, sine) for
/// each row and the next.
template <class Real>
struct RotationLog {
  Real* ranges;
  Real* rotations;
  int num_sweeps = 0, num_rotations = 0;
};

/// Takes one implicit QR step in the rows first .. last of each lane's block: d, e <- Q^T (d, e) Q, x <- Q^T x.
template <class Real>
KOKKOS_INLINE_FUNCTION void qr_sweep(const ActiveBlock<Real>& block, int first, int last, Real* d, Real* e, Real* x,
                                     Real* rotations) {
  const Real zero = Real{}, one = Real{} + 1;
  Real along = zero, bulge = zero;
  for (int k = first; k < last; ++k) {
    const Real row = zero + k;
    const MaskOf<Real> starts = row == block.low, active = (row >= block.low) & (row < block.high);
    const MaskOf<Real> goes_on = active & (row + 1 < block.high);
    const Real u = select<Real>(starts, d[k] - block.shift, along), w = select<Real>(starts, e[k], bulge);
    const Real squares = u * u + w * w;
    const MaskOf<Real> turns = active & (squares > 1e-280);
    const Real inverse = 1.0 / square_root(select<Real>(turns, squares, one));
    const Real c = select<Real>(turns, u * inverse, one), s = select<Real>(turns, w * inverse, zero);
    if (k > first) e[k - 1] = select<Real>(active & !starts, squares * inverse, e[k - 1]);
    const Real p = d[k], q = d[k + 1], t = e[k], twist = 2.0 * c * s * t;
    d[k] = select<Real>(turns, c * c * p + twist + s * s * q, p);
    d[k + 1] = select<Real>(turns, s * s * p - twist + c * c * q, q);
    along = e[k] = select<Real>(turns, c * s * (q - p) + (c * c - s * s) * t, t);
    if (k + 1 < last) {
      bulge = select<Real>(goes_on, s * e[k + 1], zero);
      e[k + 1] = select<Real>(goes_on, c * e[k + 1], e[k + 1]);
    }
    const Real above = x[k], below = x[k + 1];
    x[k] = c * above + s * below;
    x[k + 1] = c * below - s * above;
    rotations[2 * (k - first)] = c;
    rotations[2 * (k - first) + 1] = s;
  }
}

/// Iterates by implicit QR until the eigenvalues up to the threshold stand alone on the diagonal; x <- Q^T x. The other
/// eigenvalues stay in blocks that have none of them. Lanes that did not get there: false.
template <class Real>
KOKKOS_INLINE_FUNCTION MaskOf<Real> split_off(Real* d, Real* e, int n, const Real& small, const Real& threshold,
                                              Real* x, RotationLog<Real>& log) {
  constexpr double usual_sweeps = 6;
  int rows = n;
  Real end = Real{}, sweeps = Real{};  // of the block and since it has that end
  for (;;) {
    const ActiveBlock<Real> block = find_block<Real>(d, e, rows, small, threshold, sweeps > usual_sweeps);
    const MaskOf<Real> done = block.high == Real{};
    sweeps = select<Real>((block.high == end) | (sweeps > usual_sweeps), sweeps + 1, Real{});  // slow once: always
    end = block.high;
    if (!any(!done)) return done;
    int first = n, last = 0;
    for (int l = 0; l < LaneTraits<Real>::count; ++l) {
      const int low = static_cast<int>(lane(block.low, l)), high = static_cast<int>(lane(block.high, l));
      if (high == 0) continue;
      first = low < first ? low : first;
      last = high > last ? high : last;
    }
    rows = last + 1;
    const int count = last - first;
    if (log.num_sweeps == SpectralScratch::max_sweeps(n) ||
        log.num_rotations + count > SpectralScratch::max_rotations(n))
      return done;
    qr_sweep(block, first, last, d, e, x, log.rotations + 2 * log.num_rotations);
    log.ranges[2 * log.num_sweeps] = Real{} + first;
    log.ranges[2 * log.num_sweeps + 1] = Real{} + last;
    ++log.num_sweeps;
    log.num_rotations += count;
  }
}

/// x <- Q x.
template <class Real>
KOKKOS_INLINE_FUNCTION void rotate_back(const RotationLog<Real>& log, Real* x) {
  const Real* rotation = log.rotations + 2 * log.num_rotations;
  for (int i = log.num_sweeps - 1; i >= 0; --i) {
    const int first = static_cast<int>(lane(log.ranges[2 * i], 0));
    const int last = static_cast<int>(lane(log.ranges[2 * i + 1], 0));
    for (int k = last - 1; k >= first; --k) {
      rotation -= 2;
      const Real c = rotation[0], s = rotation[1], above = x[k], below = x[k + 1];
      x[k] = c * above - s * below;
      x[k + 1] = s * above + c * below;
    }
  }
}

/// x <- T^+ x for what split_off() leaves: rows that stand alone with at most the threshold on the diagonal count as
/// zero, the rest is positive definite. pivot: n numbers. Returns the number of zeros.
template <class Real>
KOKKOS_INLINE_FUNCTION Real solve_tridiagonal(const Real* d, const Real* e, int n, const Real& threshold, Real* x,
                                              Real* pivot) {
  const Real one = Real{} + 1;
  Real zeros = Real{};
  for (int k = 0; k < n; ++k) {
    const MaskOf<Real> kept = d[k] > threshold;
    Real left = d[k], right = x[k];
    if (k > 0) {
      left -= e[k - 1] * e[k - 1] * pivot[k - 1];
      right -= e[k - 1] * pivot[k - 1] * x[k - 1];
    }
    pivot[k] = 1.0 / select<Real>(kept, left, one);
    x[k] = select<Real>(kept, right, Real{});
    zeros += select<Real>(kept, Real{}, one);
  }
  for (int k = n - 1; k >= 0; --k) x[k] = pivot[k] * (k + 1 < n ? x[k] - e[k] * x[k + 1] : x[k]);
  return zeros;
}

template <class Real>
struct SpectralResult {
  MaskOf<Real> converged;
  Real truncated;  ///< number of eigenvalues that count as zero
};

/// x <- A^+ x, where eigenvalues up to relative_tolerance times the largest one count as zero (semidefinite A, of norm
/// at most `norm`; destroyed). Tridiagonal form, implicit QR for the eigenvalues that count as zero only (a patch has
/// ten of a hundred), whose rotations are applied to x and kept for the way back: 4/3 n^3 flop and some n^2 for each
/// such eigenvalue, no eigenvectors.
template <class Real>
KOKKOS_INLINE_FUNCTION SpectralResult<Real> pseudo_inverse_solve(Real* A, const Real& norm, double relative_tolerance,
                                                                 int n, Real* x, Real* scratch) {
  Real *d = scratch, *e = d + n, *factor = e + n, *work = factor + n, *ranges = work + 4 * n;
  RotationLog<Real> log{ranges, ranges + 2 * SpectralScratch::max_sweeps(n)};
  tridiagonalise(A, n, d, e, factor, work, x);
  const Real threshold = relative_tolerance * largest_eigenvalue<Real>(d, e, n, norm);
  SpectralResult<Real> result;
  result.converged = split_off<Real>(d, e, n, 1e-16 * norm, threshold, x, log);
  result.truncated = solve_tridiagonal<Real>(d, e, n, threshold, x, work);
  rotate_back(log, x);
  for (int k = n - 2; k >= 0; --k) {
    Real along = Real{};
    for (int i = k + 1; i < n; ++i) along += A[packed_row(i) + k] * x[i];
    along *= factor[k];
    for (int i = k + 1; i < n; ++i) x[i] -= along * A[packed_row(i) + k];
  }
  return result;
}

}  // namespace cgcontact
