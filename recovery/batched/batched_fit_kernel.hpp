/// The arithmetic of recovery/batched/batched_fit.hpp for as many patches as `Real` has lanes
/// (kernels/simd/lane_math.hpp): `double` on any Kokkos device, `Vector<double>` on CPUs. No branch depends on data of
/// one lane; no allocation.
///
/// Rank-one rows: with y_r = L^-1 P(d_r), the whitened row is w_r (x) y_r and G_rs = sum_b (w_r . w_s) (y_r . y_s).
/// The interior rows are sparse: their products need m^-1 only. Correction: m^-1 C^T mu, G mu = defect.
#pragma once

#include "recovery/batched/batched_fit.hpp"
#include "recovery/batched/batched_linear.hpp"

namespace cgcontact {

template <class Real, int degree, int bodies>
class FitKernel {
 public:
  using Input = FitInput<degree, bodies>;
  using Row = FitRow<bodies>;
  using Mask = MaskOf<Real>;
  using P = Polynomial<degree>;
  static constexpr int lanes = LaneTraits<Real>::count;
  static constexpr int num_interior = bodies * P::num_interior;

  enum class Solver {
    cholesky,  ///< patches that certainly have full rank; the others are marked and left as they are, unless all are
               ///< such
    spectral,  ///< truncated pseudo-inverse
    either     ///< Cholesky, and the pseudo-inverse if a lane needs it
  };

  /// Returns the rows of all kinds that `rows` rows of the input make.
  static KOKKOS_INLINE_FUNCTION int padded(int rows) {
    return (num_interior + rows + row_block - 1) / row_block * row_block;
  }
  /// Returns the work space for up to `rows` rows of the input: numbers of type Real.
  static KOKKOS_INLINE_FUNCTION std::size_t scratch_size(int rows) {
    const int n = padded(rows);
    const std::size_t packed = packed_row(n), spectral = SpectralScratch::size(n);
    const std::size_t work = packed > spectral ? packed : spectral;
    return packed + work + 5 * n + (n - num_interior + row_tile) * bodies * (6 + 3 + P::num_terms);
  }

  /// Fits one batch. patch[l]: lane l's patch; lanes from `used` on repeat others and write nothing. scratch:
  /// scratch_size() of the largest number of rows. unsolved: lanes that Solver::cholesky left.
  static KOKKOS_INLINE_FUNCTION void run(Input* const patch[lanes], FitStatus* const status[lanes], int used,
                                         double tolerance, Solver solver, Real* scratch, bool unsolved[lanes]) {
    FitKernel k(patch, scratch);
    k.read_bodies();
    k.read_rows();
    k.gram_interior();
    k.gram_rows();
    k.find_defects();
    k.bound_norm();
    k.solve(tolerance, solver, used);
    k.correct();
    k.write(status, used, unsolved);
  }

 private:
  static constexpr int T = P::num_terms, num_packed = P::num_packed, row_tile = 3;
  /// Fraction of its diagonal entry that a pivot of a mass matrix must exceed: ten digits lost.
  static constexpr double min_pivot = 1e-10;

  KOKKOS_INLINE_FUNCTION FitKernel(Input* const patch[lanes], Real* scratch) {
    int most = 0;
    for (int l = 0; l < lanes; ++l) {
      patch_[l] = patch[l];
      most = patch[l]->num_rows > most ? patch[l]->num_rows : most;
      set_lane(rows_of_lane_, l, patch[l]->num_rows);
    }
    num_ = most;
    n_ = padded(most);
    const auto take = [&scratch](std::size_t size) {
      Real* begin = scratch;
      scratch += size;
      return begin;
    };
    gram_ = take(packed_row(n_));
    scale_ = take(n_), target_ = take(n_), defect_ = take(n_), live_ = take(n_), mu_ = take(n_);
    const int tiled = n_ - num_interior + row_tile;
    weight_ = take(static_cast<std::size_t>(tiled) * bodies * 6);
    position_ = take(static_cast<std::size_t>(tiled) * bodies * 3);
    y_ = take(static_cast<std::size_t>(tiled) * bodies * T);
    work_ = scratch;
  }

  /// Adds 0 to check_ if x is finite, else NaN.
  KOKKOS_FORCEINLINE_FUNCTION void check(const Real* x, int n) {
    for (int i = 0; i < n; ++i) check_ += 0.0 * x[i];
  }

  template <class Member>
  KOKKOS_FORCEINLINE_FUNCTION void read(int n, Real* out, const Member& member) {
    const double* from[lanes];
    for (int l = 0; l < lanes; ++l) from[l] = member(patch_[l]);
    gather(from, n, out);
    check(out, n);
  }

  KOKKOS_INLINE_FUNCTION void read_bodies() {
    good_ = rows_of_lane_ == rows_of_lane_;
    for (int b = 0; b < bodies; ++b) {
      Real mass[num_packed], right[P::num_interior];
      read(num_packed, mass, [b](const Input* p) { return p->mass[b]; });
      read(6 * T, a_[b][0], [b](const Input* p) { return p->a[b][0]; });
      read(P::num_interior, right, [b](const Input* p) { return p->interior[b]; });
      for (int r = 0; r < P::num_interior; ++r) target_[b * P::num_interior + r] = right[r];
      if constexpr (degree == 2) {
        Real nu;
        read(1, &nu, [b](const Input* p) { return p->poisson_ratio + b; });
        const Mask possible = (nu > -1) & (nu <= 1);
        good_ = good_ & possible;
        stiffness_[b] = 1.0 / select<Real>(possible, 1.0 + nu, Real{} + 1);
      }
      factor_mass(mass, b);
    }
    good_ = good_ & (check_ == Real{});
  }

  /// inverse_ = L^-1, by rows; metric_ = m^-1. A mass matrix that is not positive definite: the identity.
  KOKKOS_INLINE_FUNCTION void factor_mass(Real* m, int b) {
    const Real one = Real{} + 1;
    Mask positive = good_;
    Real diagonal[T];
    for (int i = 0; i < T; ++i)
      for (int j = 0; j <= i; ++j) {
        Real sum = m[packed_row(i) + j];
        for (int k = 0; k < j; ++k) sum -= m[packed_row(i) + k] * m[packed_row(j) + k];
        if (j < i) {
          m[packed_row(i) + j] = sum * diagonal[j];
          continue;
        }
        const Mask fine = (sum > min_pivot * m[packed_row(i) + i]) & (sum > 1e-280) & (sum < 1e280);
        positive = positive & fine;
        diagonal[i] = 1.0 / square_root(select<Real>(fine, sum, one));
        m[packed_row(i) + i] = sum * diagonal[i];
      }
    good_ = good_ & positive;
    for (int i = 0; i < T; ++i)
      for (int j = 0; j <= i; ++j) {
        const Real unit = i == j ? one : Real{};
        factor_[b][packed_row(i) + j] = select<Real>(positive, m[packed_row(i) + j], unit);
        diagonal[i] = select<Real>(positive, diagonal[i], one);
      }
    for (int j = 0; j < T; ++j) {
      inverse_[b][packed_row(j) + j] = diagonal[j];
      for (int i = j + 1; i < T; ++i) {
        Real sum = Real{};
        for (int k = j; k < i; ++k) sum -= factor_[b][packed_row(i) + k] * inverse_[b][packed_row(k) + j];
        inverse_[b][packed_row(i) + j] = sum * diagonal[i];
      }
    }
    for (int i = 0; i < T; ++i)
      for (int j = 0; j <= i; ++j) {
        Real sum = Real{};
        for (int k = i; k < T; ++k) sum += inverse_[b][packed_row(k) + i] * inverse_[b][packed_row(k) + j];
        metric_[b][i][j] = metric_[b][j][i] = sum;
      }
  }

  KOKKOS_FORCEINLINE_FUNCTION Real* weight(int r, int b) const { return weight_ + (r * bodies + b) * 6; }
  KOKKOS_FORCEINLINE_FUNCTION Real* position(int r, int b) const { return position_ + (r * bodies + b) * 3; }
  KOKKOS_FORCEINLINE_FUNCTION Real* y(int r, int b) const { return y_ + (r * bodies + b) * T; }

  /// Reads normalised weights, points, whitened terms; rows that a lane has not, or that say nothing, get weight zero.
  KOKKOS_INLINE_FUNCTION void read_rows() {
    const Real zero = Real{}, one = Real{} + 1;
    constexpr int size = sizeof(Row) / sizeof(double);
    for (int r = 0; r < n_ - num_interior + row_tile; ++r) {
      if (r >= num_) {
        clear_row(r);
        continue;
      }
      Real in[size];
      const double* from[lanes];
      for (int l = 0; l < lanes; ++l)
        from[l] = r < patch_[l]->num_rows ? patch_[l]->rows[r].weight[0] : &patch_[l]->a[0][0][0];  // any numbers
      gather(from, size, in);
      const Mask exists = rows_of_lane_ > zero + r;
      Real finite = zero, squares = zero;
      for (int i = 0; i < size; ++i) finite += 0.0 * in[i];
      const Mask absent = rows_of_lane_ <= zero + r;
      good_ = good_ & ((finite == zero) | absent);
      for (int b = 0; b < bodies; ++b) {
        Real p[T], w2 = zero, y2 = zero;
        for (int i = 0; i < 3; ++i) position(r, b)[i] = select<Real>(exists & good_, in[6 * bodies + 3 * b + i], zero);
        P::terms(position(r, b), p);
        for (int i = 0; i < T; ++i) {
          Real sum = inverse_[b][packed_row(i)] * p[0];
          for (int k = 1; k <= i; ++k) sum += inverse_[b][packed_row(i) + k] * p[k];
          y(r, b)[i] = sum;
          y2 += sum * sum;
        }
        for (int c = 0; c < 6; ++c) w2 += in[6 * b + c] * in[6 * b + c];
        squares += w2 * y2;
      }
      good_ = good_ & (absent | (squares < 1e280));
      const Mask counts = exists & good_ & (squares > 1e-280);
      const Real scale = 1.0 / square_root(select<Real>(counts, squares, one));
      for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c) weight(r, b)[c] = select<Real>(counts, in[6 * b + c] * scale, zero);
      live_[num_interior + r] = select<Real>(counts, one, zero);
      idle_ += select<Real>(exists & !counts, one, zero);
      target_[num_interior + r] = select<Real>(exists & good_, in[size - 1] * scale, zero);
    }
  }

  KOKKOS_INLINE_FUNCTION void clear_row(int r) {
    for (int i = 0; i < bodies * 6; ++i) weight(r, 0)[i] = Real{};
    for (int i = 0; i < bodies * 3; ++i) position(r, 0)[i] = Real{};
    for (int i = 0; i < bodies * T; ++i) y(r, 0)[i] = Real{};
    if (num_interior + r < n_) live_[num_interior + r] = target_[num_interior + r] = Real{};
  }

  KOKKOS_INLINE_FUNCTION void gram_interior() {
    for (int b = 0; b < bodies; ++b)
      for (int r = 0; r < P::num_interior; ++r) {
        Real dense[6][T] = {}, product[P::num_interior];
        const int row = b * P::num_interior + r;
        P::visit_row(r, stiffness_[b], [&](int c, int t, const Real& entry) {
          for (int i = 0; i < T; ++i) dense[c][i] += entry * metric_[b][t][i];
        });
        P::interior([&](int c, int t) { return dense[c][t]; }, stiffness_[b], product);
        const Real scale = 1.0 / square_root(product[r]);
        scale_[row] = scale;
        live_[row] = Real{} + 1;
        target_[row] *= scale;
        Real* out = gram_ + packed_row(row);
        for (int s = 0; s < b * P::num_interior; ++s) out[s] = Real{};
        for (int s = 0; s < r; ++s) out[b * P::num_interior + s] = product[s] * scale * scale_[b * P::num_interior + s];
        out[row] = Real{} + 1;
      }
  }

  KOKKOS_INLINE_FUNCTION void gram_rows() {
    for (int r = 0; r < n_ - num_interior; ++r)
      for (int b = 0; b < bodies; ++b) {
        Real u[T], product[P::num_interior];  // u = L^-T y = m^-1 P
        const Real *w = weight(r, b), *whitened = y(r, b);
        for (int t = 1; t < T; ++t) {
          u[t] = Real{};
          for (int k = t; k < T; ++k) u[t] += inverse_[b][packed_row(k) + t] * whitened[k];
        }
        P::interior([&](int c, int t) { return w[c] * u[t]; }, stiffness_[b], product);
        Real* out = gram_ + packed_row(num_interior + r) + b * P::num_interior;
        for (int s = 0; s < P::num_interior; ++s) out[s] = product[s] * scale_[b * P::num_interior + s];
      }
    for (int r = 0; r < n_ - num_interior; r += row_tile)
      for (int s = 0; s <= r; s += row_tile) gram_tile(r, s);
  }

  KOKKOS_FORCEINLINE_FUNCTION void gram_tile(int r, int s) {
    Real sum[row_tile][row_tile] = {};
    for (int b = 0; b < bodies; ++b) {
      Real ww[row_tile][row_tile] = {}, yy[row_tile][row_tile] = {};
      multiply_tile<6>(weight(r, b), weight(s, b), ww);
      multiply_tile<T>(y(r, b), y(s, b), yy);
      for (int i = 0; i < row_tile; ++i)
        for (int j = 0; j < row_tile; ++j) sum[i][j] += ww[i][j] * yy[i][j];
    }
    for (int i = 0; i < row_tile && num_interior + r + i < n_; ++i)
      for (int j = 0; j < row_tile && s + j <= r + i; ++j)
        gram_[packed_row(num_interior + r + i) + num_interior + s + j] = s + j == r + i ? Real{} + 1 : sum[i][j];
  }

  template <int length>
  static KOKKOS_FORCEINLINE_FUNCTION void multiply_tile(const Real* x, const Real* z, Real out[row_tile][row_tile]) {
#pragma GCC unroll 10
    for (int k = 0; k < length; ++k)
#pragma GCC unroll 3
      for (int i = 0; i < row_tile; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < row_tile; ++j) out[i][j] += x[i * bodies * length + k] * z[j * bodies * length + k];
  }

  /// out = target - C a, of normalised rows.
  KOKKOS_INLINE_FUNCTION void residuals(Real* out) const {
    for (int b = 0; b < bodies; ++b) {
      Real product[P::num_interior];
      P::interior([&](int c, int t) { return a_[b][c][t]; }, stiffness_[b], product);
      for (int i = 0; i < P::num_interior; ++i) {
        const int r = b * P::num_interior + i;
        out[r] = target_[r] - product[i] * scale_[r];
      }
    }
    for (int r = 0; r < n_ - num_interior; ++r) {
      Real sum = target_[num_interior + r];
      for (int b = 0; b < bodies; ++b) {
        Real p[T];
        P::terms(position(r, b), p);
        for (int c = 0; c < 6; ++c) {
          Real stress = a_[b][c][0];
          for (int t = 1; t < T; ++t) stress += a_[b][c][t] * p[t];
          sum -= weight(r, b)[c] * stress;
        }
      }
      out[num_interior + r] = sum;
    }
  }

  KOKKOS_INLINE_FUNCTION void find_defects() {
    for (int b = 0; b < bodies; ++b)
      for (int c = 0; c < 6; ++c)
        for (int t = 0; t < T; ++t) a_[b][c][t] = select<Real>(good_, a_[b][c][t], Real{});
    for (int r = 0; r < n_; ++r) target_[r] = select<Real>(good_, target_[r], Real{});
    residuals(defect_);
    for (int r = 0; r < n_; ++r) mu_[r] = defect_[r];
  }

  /// Bounds the largest eigenvalue from above: from trace and Frobenius norm (m rows of mean eigenvalue 1: 1 + sqrt((m
  /// - 1) (|G|^2 / m - 1)), Wolkowicz and Styan 1980), and the largest entry of (|G| x)_r / x_r for a positive x, here
  /// the row sums (Collatz and Wielandt).
  KOKKOS_INLINE_FUNCTION void bound_norm() {
    Real squares = Real{}, trace = Real{}, largest = Real{};
    Real *sum = work_, *product = work_ + n_;
    for (int r = 0; r < n_; ++r) {
      const Real* row = gram_ + packed_row(r);
      trace += live_[r];
      Real own = live_[r];
      for (int s = 0; s < r; ++s) {
        own += magnitude(row[s]);
        squares += row[s] * row[s];
        sum[s] += magnitude(row[s]);
      }
      sum[r] = own;
    }
    for (int r = 0; r < n_; ++r) {
      const Real* row = gram_ + packed_row(r);
      Real own = sum[r];
      for (int s = 0; s < r; ++s) {
        own += magnitude(row[s]) * sum[s];
        product[s] += magnitude(row[s]) * sum[r];
      }
      product[r] = own;
    }
    for (int r = 0; r < n_; ++r) {
      const MaskOf<Real> counts = live_[r] > 0;
      largest = larger<Real>(largest, product[r] / select<Real>(counts, sum[r], Real{} + 1));
    }
    const Real styan = 1.0 + square_root((trace - 1.0) * (2.0 * squares / trace));
    norm_ = select<Real>(styan < largest, styan, largest);
  }

  /// Solves; full rank is certain if G - tolerance^2 norm I is positive definite (Sylvester's law of inertia).
  KOKKOS_INLINE_FUNCTION void solve(double tolerance, Solver solver, int used) {
    truncated_ = Real{};
    const Mask none = rows_of_lane_ != rows_of_lane_;
    unsolved_ = none;
    if (solver != Solver::spectral) {
      unsolved_ = good_ & !packed_cholesky<Real>(gram_, 1.001 * tolerance * tolerance * norm_, n_, work_);
      if (!any(unsolved_) || (solver == Solver::cholesky && !all_unsolved(used))) {
        packed_cholesky<Real>(gram_, Real{}, n_, work_);
        packed_cholesky_solve(work_, n_, mu_);
        return;
      }
    }
    unsolved_ = none;
    const SpectralResult<Real> result = pseudo_inverse_solve(gram_, norm_, tolerance * tolerance, n_, mu_, work_);
    good_ = good_ & result.converged;
    truncated_ = result.truncated + idle_;
  }

  KOKKOS_INLINE_FUNCTION bool all_unsolved(int used) const {
    for (int l = 0; l < used; ++l)
      if (!lane(unsolved_, l)) return false;
    return true;
  }

  /// a += m^-1 C^T mu.
  KOKKOS_INLINE_FUNCTION void correct() {
    for (int b = 0; b < bodies; ++b) {
      Real sum[6][T] = {};
      for (int i = 0; i < P::num_interior; ++i) {
        const Real factor = mu_[b * P::num_interior + i] * scale_[b * P::num_interior + i];
        P::visit_row(i, stiffness_[b], [&](int c, int t, const Real& entry) { sum[c][t] += factor * entry; });
      }
      for (int r = 0; r < n_ - num_interior; ++r) {
        Real p[T];
        P::terms(position(r, b), p);
        for (int t = 0; t < T; ++t) p[t] *= mu_[num_interior + r];
        for (int c = 0; c < 6; ++c)
          for (int t = 0; t < T; ++t) sum[c][t] += weight(r, b)[c] * p[t];
      }
      for (int c = 0; c < 6; ++c) {
        Real white[T];
        for (int i = 0; i < T; ++i) {
          white[i] = Real{};
          for (int k = 0; k <= i; ++k) white[i] += inverse_[b][packed_row(i) + k] * sum[c][k];
        }
        for (int i = 0; i < T; ++i)
          for (int k = i; k < T; ++k) a_[b][c][i] += inverse_[b][packed_row(k) + i] * white[k];
      }
    }
  }

  KOKKOS_INLINE_FUNCTION Real stress_level() const {
    Real squares = Real{};
    for (int b = 0; b < bodies; ++b)
      for (int c = 0; c < 6; ++c)
        for (int i = 0; i < T; ++i) {
          Real sum = Real{};
          for (int k = i; k < T; ++k) sum += factor_[b][packed_row(k) + i] * a_[b][c][k];
          squares += sum * sum;
        }
    return square_root(squares);
  }

  KOKKOS_INLINE_FUNCTION void write(FitStatus* const status[lanes], int used, bool unsolved[lanes]) {
    residuals(defect_);
    Real largest = Real{}, finite = Real{};
    for (int r = 0; r < n_; ++r) largest = larger(largest, magnitude(defect_[r]));
    for (int b = 0; b < bodies; ++b)
      for (int c = 0; c < 6; ++c)
        for (int t = 0; t < T; ++t) finite += 0.0 * a_[b][c][t];
    const Real level = stress_level();
    const Mask flat = level == Real{};
    const Real residual = largest / select<Real>(flat, Real{} + 1, level);
    good_ = good_ & (finite == Real{}) & (0.0 * residual == Real{});
    double* to[bodies][lanes];
    for (int l = 0; l < lanes; ++l) {
      unsolved[l] = l < used && lane(unsolved_, l);
      const bool writes = l < used && lane(good_, l) && !unsolved[l];
      for (int b = 0; b < bodies; ++b) to[b][l] = writes ? patch_[l]->a[b][0] : nullptr;
      if (l >= used || unsolved[l]) continue;
      *status[l] = FitStatus{false, 0, 0, 0};
      if (writes)
        *status[l] = FitStatus{true, num_interior + patch_[l]->num_rows, static_cast<int>(lane(truncated_, l)),
                               lane(residual, l)};
    }
    for (int b = 0; b < bodies; ++b) scatter(a_[b][0], 6 * T, to[b]);
  }

  Input* patch_[lanes];
  int num_, n_;                 ///< largest number of input rows; all rows, padded
  Real rows_of_lane_ = Real{};  ///< input rows
  Real check_ = Real{}, idle_ = Real{}, norm_, truncated_;
  Mask good_, unsolved_;
  Real a_[bodies][6][T], factor_[bodies][num_packed], inverse_[bodies][num_packed], metric_[bodies][T][T];
  Real stiffness_[bodies] = {};  ///< 1 / (1 + nu)
  Real *gram_, *scale_, *target_, *defect_, *live_, *mu_, *weight_, *position_, *y_, *work_;
};

}  // namespace cgcontact
