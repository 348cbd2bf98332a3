#include "recovery/face/cosine_transform.hpp"

#include <cmath>
#include <string>

#include "core/base/numbers/types.hpp"

namespace cgcontact {
namespace {

constexpr int lanes = Fourier::lanes, block = Fourier::columns;

using Value = Fourier::Value;
using Matrix = CosineTransform::Matrix;

/// Sets to = (re + I im) value.
KOKKOS_FORCEINLINE_FUNCTION void set_product(double re, double im, const Value& value, Value& to) {
  for (int s = 0; s < lanes; ++s) {
    to.re[s] = re * value.re[s] - im * value.im[s];
    to.im[s] = re * value.im[s] + im * value.re[s];
  }
}

/// Calls use(begin, width, x, work) for each block of columns, with memory for two arrays of `length` values. Blocks
/// are shared out among the threads.
template <class Exec, class Use>
void each_block(const char* label, const Exec& exec, int columns, int length, const Use& use) {
  using Policy = Kokkos::TeamPolicy<Exec>;
  using Scratch = Kokkos::View<double*, typename Exec::scratch_memory_space, Kokkos::MemoryUnmanaged>;
  const int doubles = 2 * length * static_cast<int>(sizeof(Value) / sizeof(double));
  Kokkos::parallel_for(
      label,
      Policy(exec, (columns + block - 1) / block, 1).set_scratch_size(1, Kokkos::PerTeam(Scratch::shmem_size(doubles))),
      KOKKOS_LAMBDA(const typename Policy::member_type& team) {
        const Scratch scratch(team.team_scratch(1), doubles);
        const int begin = team.league_rank() * block;
        auto* const x = reinterpret_cast<Value*>(scratch.data());
        use(begin, columns - begin < block ? columns - begin : block, x, x + length);
      });
}

/// Gives one of the sixteen columns of a value.
KOKKOS_FORCEINLINE_FUNCTION double& entry(Value& value, int column) {
  return column < lanes ? value.re[column] : value.im[column - lanes];
}

KOKKOS_FORCEINLINE_FUNCTION void clear(Value& value) {
  for (int s = 0; s < lanes; ++s) value.re[s] = value.im[s] = 0;
}

template <class Row>
KOKKOS_FORCEINLINE_FUNCTION void load(const Row& row, int width, Value& value) {
  if (width == block) {
    for (int s = 0; s < lanes; ++s) value.re[s] = row[s], value.im[s] = row[lanes + s];
    return;
  }
  clear(value);
  for (int s = 0; s < width; ++s) entry(value, s) = row[s];
}

/// Returns the index at which the transform of cosines keeps value i: even ones first, odd ones from the end.
KOKKOS_FORCEINLINE_FUNCTION int sorted_index(int i, int count) { return i % 2 == 0 ? i / 2 : count - 1 - i / 2; }

}  // namespace

Fourier::Fourier(int length) : length_(length), roots_(roots_of(length)) {
  for (int rest = length; rest > 1;) {
    int factor = rest % 4 == 0 ? 4 : 2;
    while (rest % factor != 0) ++factor;
    factors_[num_factors_++] = factor;
    rest /= factor;
  }
}

Fourier::Roots Fourier::roots_of(int length) {
  const Roots roots("cgcontact::cosine_transform::roots", length);
  const auto host = Kokkos::create_mirror_view(roots);
  for (int k = 0; k < length; ++k) {
    host(k, 0) = std::cos(2 * pi * k / length);
    host(k, 1) = -std::sin(2 * pi * k / length);
  }
  Kokkos::deep_copy(roots, host);
  return roots;
}

int Fourier::fast_length(int least) {
  for (int length = least;; ++length) {
    int rest = length;
    for (const int factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return length;
  }
}

double Fourier::flop() const {
  double of_value = 0;
  for (int f = 0; f < num_factors_; ++f) of_value += factors_[f] == 4 ? 12 : 8 * (factors_[f] - 1) + 6;
  return of_value * length_ * lanes;
}

/// Each step takes a factor r out of the length n = r m of what is left, of which there are s side by side:
/// y[(j r + q) s + k] = exp(-2 pi I j q / n) sum_p exp(-2 pi I p q / r) x[(p m + j) s + k].
KOKKOS_FUNCTION Fourier::Value* Fourier::transform(Value* x, Value* y) const {
  int s = 1;
  for (int f = 0; f < num_factors_; ++f) {
    const int r = factors_[f], m = length_ / (r * s), step = length_ / r;
    for (int j = 0; j < m; ++j)
      for (int k = 0; k < s; ++k) {
        const Value* const from = x + j * s + k;  // x_p lies p m s beyond
        Value* const to = y + j * r * s + k;
        const int apart = m * s;
        if (r == 4) {
          Value sum;
          for (int q = 0; q < 4; ++q) {
            const Value &a = from[0], &b = from[apart], &c = from[2 * apart], &d = from[3 * apart];
            for (int t = 0; t < lanes; ++t) {
              if (q % 2 == 0) {
                const double sign = q == 0 ? 1 : -1;
                sum.re[t] = a.re[t] + c.re[t] + sign * (b.re[t] + d.re[t]);
                sum.im[t] = a.im[t] + c.im[t] + sign * (b.im[t] + d.im[t]);
              } else {
                const double sign = q == 1 ? 1 : -1;  // times -I, I
                sum.re[t] = a.re[t] - c.re[t] + sign * (b.im[t] - d.im[t]);
                sum.im[t] = a.im[t] - c.im[t] - sign * (b.re[t] - d.re[t]);
              }
            }
            set_product(roots_(j * q * s, 0), roots_(j * q * s, 1), sum, to[q * s]);
          }
          continue;
        }
        for (int q = 0; q < r; ++q) {
          Value sum = from[0];
          for (int p = 1; p < r; ++p) {
            const int power = p * q % r * step;
            const double re = roots_(power, 0), im = roots_(power, 1);
            const Value& value = from[p * apart];
            for (int t = 0; t < lanes; ++t) {
              sum.re[t] += re * value.re[t] - im * value.im[t];
              sum.im[t] += re * value.im[t] + im * value.re[t];
            }
          }
          set_product(roots_(j * q * s, 0), roots_(j * q * s, 1), sum, to[q * s]);
        }
      }
    Value* const swapped = x;
    x = y;
    y = swapped;
    s *= r;
  }
  return x;
}

CosineTransform::CosineTransform(int size, int first, int count)
    : size_(size), first_(first), fourier_(count), quarter_(Fourier::roots_of(4 * count)) {}

/// Takes the cosines' sums of x_i as Re(exp(-pi I k / (2 count)) V_k), V the transform of x in sorted order (Makhoul,
/// IEEE Trans. ASSP 28 (1980) 27).
template <class Exec>
void CosineTransform::forward(const Exec& exec, const Matrix& values, const Matrix& factor,
                              const Matrix& spectrum) const {
  static_assert(Kokkos::SpaceAccessibility<Exec, MemSpace>::accessible);
  const int size = size_, first = first_, count = fourier_.length();
  const bool scaled = factor.extent(0) > 0;
  const Fourier fourier = fourier_;
  const Fourier::Roots quarter = quarter_;
  each_block(
      "cgcontact::cosine_transform::forward", exec, static_cast<int>(values.extent(1)), count,
      KOKKOS_LAMBDA(int begin, int width, Value* x, Value* work) {
        for (int i = 0; i < count; ++i) clear(x[i]);
        for (int i = 0; i < size; ++i) load(&values(i, begin), width, x[sorted_index(first + i, count)]);
        Value* const v = fourier.transform(x, work);
        Value* const sums = v == x ? work : x;
        for (int k = 0; k < count; ++k) {
          const double c = quarter(k, 0), s = -quarter(k, 1);
          const Value &a = v[k], &b = v[k == 0 ? 0 : count - k];
          Value& to = sums[k];
          for (int t = 0; t < lanes; ++t) {  // of two real columns: V_k and the conjugate of V_(count - k)
            to.re[t] = 0.5 * (c * (a.re[t] + b.re[t]) + s * (a.im[t] - b.im[t]));
            to.im[t] = 0.5 * (c * (a.im[t] + b.im[t]) - s * (a.re[t] - b.re[t]));
          }
        }
        for (int column = 0; column < width; ++column)
          for (int k = 0; k < count; ++k) {
            const double sum = entry(sums[k], column);
            spectrum(begin + column, k) = scaled ? factor(begin + column, k) * sum : sum;
          }
      });
}

/// Takes the steps of `forward` back to front: the sorted values are Re of the transform of exp(pi I k / (2 count))
/// Y_k, made real by its other half.
template <class Exec>
void CosineTransform::backward(const Exec& exec, const Matrix& spectrum, const Matrix& values) const {
  static_assert(Kokkos::SpaceAccessibility<Exec, MemSpace>::accessible);
  const int size = size_, first = first_, count = fourier_.length();
  const Fourier fourier = fourier_;
  const Fourier::Roots quarter = quarter_;
  each_block(
      "cgcontact::cosine_transform::backward", exec, static_cast<int>(values.extent(1)), count,
      KOKKOS_LAMBDA(int begin, int width, Value* x, Value* work) {
        for (int k = 0; k < count; ++k) clear(work[k]);
        for (int column = 0; column < width; ++column)
          for (int k = 0; k < count; ++k) entry(work[k], column) = spectrum(begin + column, k);
        for (int k = 0; k < count; ++k) {
          const double c = quarter(k, 0), s = -quarter(k, 1);
          const Value &a = work[k], &b = work[k == 0 ? 0 : count - k];
          const double weight = k == 0 ? 1 : 0.5, other = k == 0 ? 0 : 0.5;
          for (int t = 0; t < lanes; ++t) {
            // exp(-pi I k / (2 count)) (Y_k + I Y_(count - k)): the transform of the conjugate is the conjugate, and
            // the columns in the imaginary parts are real as well.
            const double re = c * weight * a.re[t] + s * other * b.re[t];
            const double im = c * other * b.re[t] - s * weight * a.re[t];
            const double re_of_im = c * weight * a.im[t] + s * other * b.im[t];
            const double im_of_im = c * other * b.im[t] - s * weight * a.im[t];
            x[k].re[t] = re - im_of_im;
            x[k].im[t] = im + re_of_im;
          }
        }
        Value* const v = fourier.transform(x, work);
        for (int i = 0; i < size; ++i) {
          Value& from = v[sorted_index(first + i, count)];
          for (int column = 0; column < width; ++column) values(i, begin + column) = entry(from, column);
        }
      });
}

template <class Exec>
void even_spectrum(const Exec& exec, int count, const Matrix& table, const Matrix& spectrum) {
  const int reach = static_cast<int>(table.extent(0)) - 1;
  const Fourier fourier(2 * count);
  each_block(
      "cgcontact::cosine_transform::even_spectrum", exec, static_cast<int>(table.extent(1)), 2 * count,
      KOKKOS_LAMBDA(int begin, int width, Value* x, Value* work) {
        for (int i = 0; i < 2 * count; ++i) clear(x[i]);
        for (int d = 0; d <= reach; ++d) {
          load(&table(d, begin), width, x[d]);
          if (d > 0) x[2 * count - d] = x[d];
        }
        Value* const v = fourier.transform(x, work);
        for (int column = 0; column < width; ++column)
          for (int k = 0; k < count; ++k) spectrum(begin + column, k) = entry(v[k], column);
      });
}

#define CGCONTACT_INSTANTIATE(Exec)                                                                       \
  template void CosineTransform::forward(const Exec&, const Matrix&, const Matrix&, const Matrix&) const; \
  template void CosineTransform::backward(const Exec&, const Matrix&, const Matrix&) const;               \
  template void even_spectrum(const Exec&, int, const Matrix&, const Matrix&);

CGCONTACT_INSTANTIATE(ExecSpace)
#if defined(KOKKOS_ENABLE_SERIAL) && defined(KOKKOS_ENABLE_OPENMP)
CGCONTACT_INSTANTIATE(Kokkos::Serial)  // for the tests, where ExecSpace is the other one
#endif
#undef CGCONTACT_INSTANTIATE

}  // namespace cgcontact
