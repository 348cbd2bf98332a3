/// Fast transforms of cosines against their sums, and what they say of the half-space's compliance.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/numbers/types.hpp"
#include "recovery/face/cosine_transform.hpp"
#include "tests/support/execution_spaces.hpp"

namespace cgcontact::test_cosine_transform {
namespace {

using Matrix = CosineTransform::Matrix;

/// Numbers without a pattern between -1 and 1.
double number(int i, int j) { return (37 * i + 101 * j + i * j) % 97 / 48.0 - 1; }

Matrix matrix(int rows, int columns) {
  const Matrix values("values", rows, columns);
  const auto host = Kokkos::create_mirror_view(values);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) host(i, j) = number(i, j);
  Kokkos::deep_copy(values, host);
  return values;
}

double cosine(int i, int k, int count) { return std::cos(pi * k * (i + 0.5) / count); }

/// Rounding of sums of `count` terms of size 1: the transform's grows like its logarithm, that of the sums like its
/// root.
double tolerance(int count) { return 1e-14 * count; }

template <class Exec>
class CosineTransforms : public testing::Test {};
TYPED_TEST_SUITE(CosineTransforms, ExecutionSpaces);

/// Calls use(size, first, count, columns) for lengths of one factor and of many, odd ones and primes; columns that fill
/// the lanes and that do not.
template <class Use>
void each_shape(const Use& use) {
  for (const int count : {1, 2, 3, 4, 7, 8, 13, 16, 24, 30, 64, 90, 97})
    for (const int columns : {1, 16, 37}) use(std::max(1, count / 2), count / 3, count, columns);
}

TYPED_TEST(CosineTransforms, SumsOfCosines) {
  const TypeParam exec;
  each_shape([&](int size, int first, int count, int columns) {
    const Matrix values = matrix(size, columns), spectrum("spectrum", columns, count);
    CosineTransform(size, first, count).forward(exec, values, Matrix(), spectrum);
    exec.fence();
    const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), spectrum);
    for (int j = 0; j < columns; ++j)
      for (int k = 0; k < count; ++k) {
        double sum = 0;
        for (int i = 0; i < size; ++i) sum += number(i, j) * cosine(first + i, k, count);
        ASSERT_NEAR(host(j, k), sum, tolerance(count)) << count << " " << columns << " " << j << " " << k;
      }
  });
}

TYPED_TEST(CosineTransforms, AndBack) {
  const TypeParam exec;
  each_shape([&](int size, int first, int count, int columns) {
    const Matrix spectrum = matrix(columns, count), values("values", size, columns);
    CosineTransform(size, first, count).backward(exec, spectrum, values);
    exec.fence();
    const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), values);
    for (int j = 0; j < columns; ++j)
      for (int i = 0; i < size; ++i) {
        double sum = 0;
        for (int k = 0; k < count; ++k) sum += number(j, k) * cosine(first + i, k, count);
        ASSERT_NEAR(host(i, j), sum, tolerance(count)) << count << " " << columns << " " << i << " " << j;
      }
  });
}

/// Each entry of the spectrum takes its own factor.
TYPED_TEST(CosineTransforms, Factors) {
  const TypeParam exec;
  const int count = 24, columns = 19;
  const Matrix values = matrix(12, columns), plain("plain", columns, count), scaled("scaled", columns, count),
               factor = matrix(columns, count);
  const CosineTransform transform(12, 6, count);
  transform.forward(exec, values, Matrix(), plain);
  transform.forward(exec, values, factor, scaled);
  exec.fence();
  const auto a = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), plain);
  const auto b = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), scaled);
  for (int j = 0; j < columns; ++j)
    for (int k = 0; k < count; ++k) EXPECT_EQ(b(j, k), number(j, k) * a(j, k));
}

/// The offsets end before the period, or at it: there both ends are one.
TYPED_TEST(CosineTransforms, EvenOffsets) {
  const TypeParam exec;
  for (const int count : {1, 6, 16, 35})
    for (const int reach : {count / 2, count}) {
      const int columns = 18;
      const Matrix table = matrix(reach + 1, columns), spectrum("spectrum", columns, count);
      even_spectrum(exec, count, table, spectrum);
      exec.fence();
      const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), spectrum);
      for (int j = 0; j < columns; ++j)
        for (int k = 0; k < count; ++k) {
          double sum = number(0, j);
          for (int d = 1; d <= reach; ++d) sum += (d == count ? 1 : 2) * number(d, j) * std::cos(pi * k * d / count);
          ASSERT_NEAR(host(j, k), sum, 2 * tolerance(count)) << count << " " << reach << " " << j << " " << k;
        }
    }
}

TEST(Fourier, FastLengths) {
  EXPECT_EQ(Fourier::fast_length(1), 1);
  EXPECT_EQ(Fourier::fast_length(14), 15);
  EXPECT_EQ(Fourier::fast_length(1400), 1440);
  EXPECT_EQ(Fourier::fast_length(1024), 1024);
}

}  // namespace
}  // namespace cgcontact::test_cosine_transform
