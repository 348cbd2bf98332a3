/// Fast cosine transforms of the columns of a matrix, for any length.
#pragma once

#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Discrete Fourier transforms of one length, sixteen real columns at a time: two in the real and imaginary parts of
/// each of eight lanes. Stockham's self-sorting form (Van Loan, Computational Frameworks for the Fast Fourier
/// Transform, 1992, section 1.7) for each prime factor, pairs of twos as fours, in a fixed order.
class Fourier {
 public:
  static constexpr int lanes = 8, columns = 2 * lanes;
  static constexpr int max_factors = 31;

  /// exp(-2 pi I k / length): (k, real and imaginary part).
  using Roots = Kokkos::View<double* [2], Kokkos::LayoutRight, MemSpace>;

  /// Real and imaginary parts of a value in all lanes.
  struct Value {
    double re[lanes], im[lanes];
  };

  explicit Fourier(int length = 1);

  int length() const { return length_; }
  /// Replaces x, of as many values as the length, by sum_i x_i exp(-2 pi I i k / length); `work` is as long. Returns
  /// which of the two holds the result.
  KOKKOS_FUNCTION Value* transform(Value* x, Value* work) const;
  /// Counts the floating-point operations of a transform of sixteen columns, from the loops.
  double flop() const;

  /// Makes all roots of a length.
  static Roots roots_of(int length);
  /// Gives the least length from `least` on without factors but 2, 3 and 5.
  static int fast_length(int least);

 private:
  int length_, num_factors_ = 0;
  int factors_[max_factors];
  Roots roots_;
};

/// Transform by sums of cosines cos(pi k (i + 1/2) / count), k = 0 ... count - 1, at i = first ... first + size - 1.
class CosineTransform {
 public:
  /// (rows, columns)
  using Matrix = Kokkos::View<double**, Kokkos::LayoutRight, MemSpace>;

  CosineTransform() = default;
  CosineTransform(int size, int first, int count);

  /// Sets spectrum(column, k) = sum_i values(i, column) cos(...), times factor(column, k) where that has any entries.
  /// values: (size, columns); spectrum: (columns, count).
  template <class Exec>
  void forward(const Exec& exec, const Matrix& values, const Matrix& factor, const Matrix& spectrum) const;

  /// Sets values(i, column) = sum_k spectrum(column, k) cos(...). Shapes as of `forward`, which it transposes.
  template <class Exec>
  void backward(const Exec& exec, const Matrix& spectrum, const Matrix& values) const;

 private:
  int size_ = 0, first_ = 0;
  Fourier fourier_;         ///< of count
  Fourier::Roots quarter_;  ///< of four times count: quarters of its angles
};

/// Sets spectrum(column, k) = sum over d = -reach ... reach of table(|d|, column) cos(pi k d / count), k < count; where
/// reach is count, the period, both ends are one. table: (reach + 1, columns); spectrum: (columns, count).
template <class Exec>
void even_spectrum(const Exec& exec, int count, const CosineTransform::Matrix& table,
                   const CosineTransform::Matrix& spectrum);

}  // namespace cgcontact
