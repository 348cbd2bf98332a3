/// The arithmetic of recovery/batched/batched_fit.hpp for as many patches as `Real` has lanes
/// (kernels/simd/lane_math.hpp): `double` on any Kokkos device, `Vector<double>` on CPUs. No branch depends on data of
/// one lane; no allocation.
///
/// Rank-one rows: with y_r = L^-1 P(d_r), the whitened row is w_r (x) y_r and G_rs = sum_b (w_r . w_s) (y_r . y_s).
/// The interior rows are sparse: their products need m^-1 only. Correction: m^-1 C^T mu, G mu = defect.
///
/// The interior rows hold whatever the others ask for (paper, equation 4), and are independent: they are eliminated
/// first, body by body, K = L L^T, W = L^-1 (rows among interior ones and others). What is left of the other rows,
/// S = G - W^T W, is truncated. Where a sliver of a cell leaves the interior rows dependent, all are truncated
/// together.
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

  /// How patches are solved; those that it cannot solve are marked and left as they are.
  enum class Solver {
    cholesky,  ///< patches of full rank; where all patches have less: as `spectral`
    spectral,  ///< interior rows eliminated, truncated pseudo-inverse of the others
    together   ///< truncated pseudo-inverse of all rows
  };

  /// Rows that `rows` rows of the input make.
  static KOKKOS_INLINE_FUNCTION constexpr int padded(int rows) {
    return (rows + row_block - 1) / row_block * row_block;
  }
  /// Work space for up to `rows` rows of the input: numbers of type Real.
  static KOKKOS_INLINE_FUNCTION std::size_t scratch_size(int rows, Solver solver) {
    const int m = padded(rows), n = num_interior + m;
    const std::size_t packed = packed_row(m), spectral = SpectralScratch::size(m);
    const std::size_t work = solver == Solver::together ? packed_row(n) + SpectralScratch::size(n)
                             : packed > spectral        ? packed
                                                        : spectral;
    return packed + work + 2 * bodies * packed_row(padded_interior) + m * bodies * padded_interior + num_interior +
           3 * n + m * bodies * (6 + 3 + P::num_terms) + m / row_block * bodies;
  }

  /// patch[l]: lane l's patch; lanes from `used` on repeat others and write nothing. scratch: scratch_size() of the
  /// largest number of rows. unsolved: lanes that Solver::cholesky left.
  static KOKKOS_INLINE_FUNCTION void run(Input* const patch[lanes], FitStatus* const status[lanes], int used,
                                         double tolerance, Solver solver, Real* scratch, bool unsolved[lanes]) {
    FitKernel k(patch, scratch);
    k.read_bodies();
    k.read_rows();
    k.find_parts();
    k.gram_interior();
    k.gram_rows();
    k.find_defects();
    if (solver == Solver::together)
      k.solve_together(tolerance);
    else
      k.solve_reduced(tolerance, solver, used);
    k.correct();
    k.write(status, used, unsolved);
  }

 private:
  static constexpr int T = P::num_terms, num_packed = P::num_packed;
  static constexpr int padded_interior = padded(P::num_interior);  ///< of one body
  /// A pivot of a mass matrix must exceed this part of its diagonal entry: ten digits lost.
  static constexpr double min_pivot = 1e-10;

  KOKKOS_INLINE_FUNCTION FitKernel(Input* const patch[lanes], Real* scratch) {
    int most = 0;
    for (int l = 0; l < lanes; ++l) {
      patch_[l] = patch[l];
      most = patch[l]->num_rows > most ? patch[l]->num_rows : most;
      set_lane(rows_of_lane_, l, patch[l]->num_rows);
    }
    num_ = most;
    m_ = padded(most);
    n_ = num_interior + m_;
    const auto take = [&scratch](std::size_t size) {
      Real* begin = scratch;
      scratch += size;
      return begin;
    };
    gram_ = take(packed_row(m_));
    interior_ = take(bodies * packed_row(padded_interior));
    interior_factor_ = take(bodies * packed_row(padded_interior));
    coupling_ = take(static_cast<std::size_t>(m_) * bodies * padded_interior);
    scale_ = take(num_interior), target_ = take(n_), defect_ = take(n_), mu_ = take(n_);
    weight_ = take(static_cast<std::size_t>(m_) * bodies * 6);
    place_ = take(static_cast<std::size_t>(m_) * bodies * 3);
    y_ = take(static_cast<std::size_t>(m_) * bodies * T);
    part_ = take(m_ / row_block * bodies);
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
  KOKKOS_FORCEINLINE_FUNCTION Real* place(int r, int b) const { return place_ + (r * bodies + b) * 3; }
  KOKKOS_FORCEINLINE_FUNCTION Real* y(int r, int b) const { return y_ + (r * bodies + b) * T; }

  /// Normalised weights, places, whitened terms; rows that a lane has not, or that say nothing, get weight zero.
  KOKKOS_INLINE_FUNCTION void read_rows() {
    const Real zero = Real{}, one = Real{} + 1;
    constexpr int size = sizeof(Row) / sizeof(double);
    for (int r = 0; r < m_; ++r) {
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
        for (int i = 0; i < 3; ++i) place(r, b)[i] = select<Real>(exists & good_, in[6 * bodies + 3 * b + i], zero);
        P::terms(place(r, b), p);
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
      idle_ += select<Real>(exists & !counts, one, zero);
      target_[num_interior + r] = select<Real>(exists & good_, in[size - 1] * scale, zero);
    }
  }

  KOKKOS_INLINE_FUNCTION void clear_row(int r) {
    for (int i = 0; i < bodies * 6; ++i) weight(r, 0)[i] = Real{};
    for (int i = 0; i < bodies * 3; ++i) place(r, 0)[i] = Real{};
    for (int i = 0; i < bodies * T; ++i) y(r, 0)[i] = Real{};
    target_[num_interior + r] = Real{};
  }

  /// Whether a body has a part in any row of a block, in any lane: where not, its products are zero.
  KOKKOS_FORCEINLINE_FUNCTION bool has_part(int r, int b) const {
    return bodies == 1 || lane(part_[r / row_block * bodies + b], 0) != 0;
  }
  KOKKOS_INLINE_FUNCTION void find_parts() {
    for (int r = 0; r < m_; r += row_block)
      for (int b = 0; b < bodies; ++b) {
        Mask some = rows_of_lane_ != rows_of_lane_;
        for (int i = r; i < r + row_block; ++i)
          for (int c = 0; c < 6; ++c) some = some | (weight(i, b)[c] != Real{});
        part_[r / row_block * bodies + b] = Real{} + (any(some) ? 1 : 0);
      }
  }

  KOKKOS_FORCEINLINE_FUNCTION Real* interior(int b) const { return interior_ + b * packed_row(padded_interior); }
  KOKKOS_FORCEINLINE_FUNCTION Real* interior_factor(int b) const {
    return interior_factor_ + b * packed_row(padded_interior);
  }
  /// A row's products with the interior rows of a body, then what elimination makes of them.
  KOKKOS_FORCEINLINE_FUNCTION Real* coupling(int r, int b) const {
    return coupling_ + (r * bodies + b) * padded_interior;
  }

  KOKKOS_INLINE_FUNCTION void gram_interior() {
    for (int b = 0; b < bodies; ++b) {
      for (int r = 0; r < P::num_interior; ++r) {
        Real dense[6][T] = {}, product[P::num_interior];
        const int row = b * P::num_interior + r;
        P::visit_row(r, stiffness_[b], [&](int c, int t, const Real& entry) {
          for (int i = 0; i < T; ++i) dense[c][i] += entry * metric_[b][t][i];
        });
        P::interior([&](int c, int t) { return dense[c][t]; }, stiffness_[b], product);
        const Real scale = 1.0 / square_root(product[r]);
        scale_[row] = scale;
        target_[row] *= scale;
        Real* out = interior(b) + packed_row(r);
        for (int s = 0; s < r; ++s) out[s] = product[s] * scale * scale_[b * P::num_interior + s];
        out[r] = Real{} + 1;
      }
      for (int r = P::num_interior; r < padded_interior; ++r)
        for (int s = 0; s <= r; ++s) interior(b)[packed_row(r) + s] = Real{} + (s == r ? 1 : 0);
    }
  }

  KOKKOS_INLINE_FUNCTION void gram_rows() {
    for (int r = 0; r < m_; ++r)
      for (int b = 0; b < bodies; ++b) {
        if (!has_part(r, b)) {
          for (int s = 0; s < padded_interior; ++s) coupling(r, b)[s] = Real{};
          continue;
        }
        Real u[T], product[P::num_interior];  // u = L^-T y = m^-1 P
        const Real *w = weight(r, b), *whitened = y(r, b);
        for (int t = 1; t < T; ++t) {
          u[t] = Real{};
          for (int k = t; k < T; ++k) u[t] += inverse_[b][packed_row(k) + t] * whitened[k];
        }
        P::interior([&](int c, int t) { return w[c] * u[t]; }, stiffness_[b], product);
        Real* out = coupling(r, b);
        for (int s = 0; s < P::num_interior; ++s) out[s] = product[s] * scale_[b * P::num_interior + s];
        for (int s = P::num_interior; s < padded_interior; ++s) out[s] = Real{};
      }
    for (int r = 0; r < m_; r += row_block)
      for (int s = 0; s <= r; s += row_block) gram_tile(r, s);
  }

  KOKKOS_FORCEINLINE_FUNCTION void gram_tile(int r, int s) {
    Real sum[row_block][row_block] = {};
    for (int b = 0; b < bodies; ++b) {
      if (!has_part(r, b) || !has_part(s, b)) continue;
      Real ww[row_block][row_block] = {}, yy[row_block][row_block] = {};
      multiply_tile<6>(weight(r, b), weight(s, b), bodies * 6, ww);
      multiply_tile<T>(y(r, b), y(s, b), bodies * T, yy);
      for (int i = 0; i < row_block; ++i)
        for (int j = 0; j < row_block; ++j) sum[i][j] += ww[i][j] * yy[i][j];
    }
    for (int i = 0; i < row_block; ++i)
      for (int j = 0; j < row_block && s + j <= r + i; ++j)
        gram_[packed_row(r + i) + s + j] = s + j == r + i ? Real{} + 1 : sum[i][j];
  }

  /// out += the products of row_block rows x and z, `stride` numbers apart.
  template <int length>
  static KOKKOS_FORCEINLINE_FUNCTION void multiply_tile(const Real* x, const Real* z, int stride,
                                                        Real out[row_block][row_block]) {
#pragma GCC unroll 10
    for (int k = 0; k < length; ++k)
#pragma GCC unroll 4
      for (int i = 0; i < row_block; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < row_block; ++j) out[i][j] += x[i * stride + k] * z[j * stride + k];
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
    for (int r = 0; r < m_; ++r) {
      Real sum = target_[num_interior + r];
      for (int b = 0; b < bodies; ++b) {
        Real p[T];
        P::terms(place(r, b), p);
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

  /// Marks the lanes whose interior rows are independent and eliminates these rows: S in gram_, W in coupling_, what
  /// belongs to them in mu_.
  KOKKOS_INLINE_FUNCTION Mask eliminate_interior(double tolerance) {
    Mask independent = good_;
    for (int b = 0; b < bodies; ++b) {
      const Mask regular =
          packed_cholesky<Real>(interior(b), Real{}, padded_interior, interior_factor(b), tolerance * tolerance);
      independent = independent & regular;
      packed_forward(interior_factor(b), P::num_interior, mu_ + b * P::num_interior);
    }
    for (int r = 0; r < m_; r += row_block) {
      for (int b = 0; b < bodies; ++b)
        if (has_part(r, b))
          packed_forward_rows(interior_factor(b), padded_interior, coupling(r, b), bodies * padded_interior);
      for (int s = 0; s <= r; s += row_block) subtract_products(r, s);
      for (int i = r; i < r + row_block; ++i)
        for (int b = 0; b < bodies; ++b)
          for (int k = 0; k < P::num_interior; ++k)
            mu_[num_interior + i] -= coupling(i, b)[k] * mu_[b * P::num_interior + k];
    }
    return independent;
  }

  KOKKOS_FORCEINLINE_FUNCTION void subtract_products(int r, int s) {
    Real sum[row_block][row_block] = {};
    for (int b = 0; b < bodies; ++b)
      if (has_part(r, b) && has_part(s, b))
        multiply_tile<P::num_interior>(coupling(r, b), coupling(s, b), bodies * padded_interior, sum);
    for (int i = 0; i < row_block; ++i)
      for (int j = 0; j < row_block && s + j <= r + i; ++j) gram_[packed_row(r + i) + s + j] -= sum[i][j];
  }

  /// The multipliers of the interior rows from those of the others.
  KOKKOS_INLINE_FUNCTION void substitute_interior() {
    for (int r = 0; r < m_; ++r)
      for (int b = 0; b < bodies; ++b)
        for (int k = 0; k < P::num_interior; ++k)
          mu_[b * P::num_interior + k] -= coupling(r, b)[k] * mu_[num_interior + r];
    for (int b = 0; b < bodies; ++b) packed_back(interior_factor(b), P::num_interior, mu_ + b * P::num_interior);
  }

  /// Full rank: S - tolerance^2 I is positive definite (Sylvester's law of inertia).
  KOKKOS_INLINE_FUNCTION void solve_reduced(double tolerance, Solver solver, int used) {
    truncated_ = Real{};
    const Real threshold = Real{} + tolerance * tolerance;
    Real* const mu = mu_ + num_interior;
    const Mask independent = eliminate_interior(tolerance);
    unsolved_ = good_ & !independent;
    if (m_ > 0) {
      const Mask dependent = unsolved_;
      if (solver == Solver::cholesky) {
        const Mask full = packed_cholesky<Real>(gram_, threshold, m_, work_);
        unsolved_ = unsolved_ | (good_ & !full);
      }
      if (solver == Solver::cholesky && !all_unsolved(used)) {
        packed_cholesky<Real>(gram_, Real{}, m_, work_);
        packed_cholesky_solve(work_, m_, mu);
      } else {
        unsolved_ = dependent;
        truncate(gram_, threshold, m_, mu, work_);
      }
    }
    substitute_interior();
  }

  /// x <- A^+ x without the eigenvalues up to the threshold.
  KOKKOS_INLINE_FUNCTION void truncate(Real* A, const Real& threshold, int n, Real* x, Real* scratch) {
    const SpectralResult<Real> result = pseudo_inverse_solve(A, threshold, n, x, scratch);
    good_ = good_ & result.converged;
    truncated_ = result.truncated + idle_;
  }

  KOKKOS_INLINE_FUNCTION void solve_together(double tolerance) {
    Real* const gram = work_;
    for (int b = 0; b < bodies; ++b)
      for (int i = 0; i < P::num_interior; ++i) {
        Real* out = gram + packed_row(b * P::num_interior + i);
        for (int s = 0; s < b * P::num_interior; ++s) *out++ = Real{};
        for (int s = 0; s <= i; ++s) *out++ = interior(b)[packed_row(i) + s];
      }
    for (int r = 0; r < m_; ++r) {
      Real* out = gram + packed_row(num_interior + r);
      for (int b = 0; b < bodies; ++b)
        for (int s = 0; s < P::num_interior; ++s) *out++ = coupling(r, b)[s];
      for (int s = 0; s <= r; ++s) *out++ = gram_[packed_row(r) + s];
    }
    unsolved_ = rows_of_lane_ != rows_of_lane_;
    truncate(gram, Real{} + tolerance * tolerance, n_, mu_, gram + packed_row(n_));
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
      for (int r = 0; r < m_; ++r) {
        Real p[T];
        P::terms(place(r, b), p);
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
  int num_, m_, n_;             ///< largest number of input rows; that padded, and with the interior ones
  Real rows_of_lane_ = Real{};  ///< input rows
  Real check_ = Real{}, idle_ = Real{}, truncated_;
  Mask good_, unsolved_;
  Real a_[bodies][6][T], factor_[bodies][num_packed], inverse_[bodies][num_packed], metric_[bodies][T][T];
  Real stiffness_[bodies] = {};  ///< 1 / (1 + nu)
  Real *gram_, *interior_, *interior_factor_, *coupling_, *scale_, *target_, *defect_, *mu_, *weight_, *place_, *y_,
      *part_, *work_;
};

}  // namespace cgcontact
