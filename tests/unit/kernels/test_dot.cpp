/// Scalar products whose last bit does not depend on how many threads there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernels/mesh/dot.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact::test_dot {
namespace {

/// Values of very different size, whose sum depends on the order of the additions.
template <class Real>
Kokkos::View<Real*, MemSpace> values(int n, double phase) {
  const Kokkos::View<Real*, MemSpace> x("values", n);
  const auto host = Kokkos::create_mirror_view(x);
  for (int i = 0; i < n; ++i) host(i) = static_cast<Real>(std::sin(i + phase) * std::pow(10.0, i % 17 - 8));
  Kokkos::deep_copy(x, host);
  return x;
}

template <class View>
double in_blocks(const View& x, const View& y) {
  constexpr int block = 4096, lanes = 16;
  const int n = static_cast<int>(x.extent(0));
  double total = 0;
  for (int begin = 0; begin < n; begin += block) {
    double lane_sums[lanes] = {}, sum = 0;
    const int end = std::min(n, begin + block);
    int i = begin;
    for (; i + lanes <= end; i += lanes)
      for (int l = 0; l < lanes; ++l) lane_sums[l] += static_cast<double>(x(i + l)) * y(i + l);
    for (; i < end; ++i) sum += static_cast<double>(x(i)) * y(i);
    for (const double p : lane_sums) sum += p;
    total += sum;
  }
  return total;
}

// Equal to the sum in order but for fused multiplications and additions (1e-15 of the magnitudes), and to the last bit
// each time.
template <class Real>
void expect_ordered(int n) {
  const auto x = values<Real>(n, 0), y = values<Real>(n, 0.3);
  const auto host_x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), x);
  const auto host_y = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), y);
  double magnitudes = 0;
  for (int i = 0; i < n; ++i) magnitudes += std::abs(static_cast<double>(host_x(i)) * host_y(i));
  const double first = dot(ExecSpace(), x, y);
  EXPECT_NEAR(first, in_blocks(host_x, host_y), 1e-15 * magnitudes);
  for (int again = 0; again < 5; ++again) EXPECT_EQ(dot(ExecSpace(), x, y), first);
}

TEST(Dot, IsTheOrderedSum) {
  for (const int n : {0, 1, 15, 4095, 4096, 4097, 100000}) {
    expect_ordered<double>(n);
    expect_ordered<float>(n);
  }
}

}  // namespace
}  // namespace cgcontact::test_dot
