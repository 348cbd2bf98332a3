/// Scalar products that do not depend on the number of threads.
#pragma once

#include <Kokkos_Core.hpp>

#include "kernels/mesh/launch.hpp"

namespace cgcontact {

/// Sums x(i) y(i), in double precision, over all entries of two views of the same length that `exec` reaches. Blocks of
/// fixed size are summed side by side and their sums added in order, so that the result is bitwise the same on any
/// number of threads (Kokkos' own reductions add what each thread has).
template <class Exec, class X, class Y>
double dot(const Exec& exec, const X& x, const Y& y) {
  constexpr int block = 4096, lanes = 16;  // independent sums: one would wait for the previous addition every time
  const int n = static_cast<int>(x.extent(0)), num_blocks = (n + block - 1) / block;
  const Kokkos::View<double*, typename Exec::memory_space> sums(
      Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::dot"), num_blocks);
  launch(
      "cgcontact::dot", Kokkos::RangePolicy<Exec>(exec, 0, num_blocks), 1, KOKKOS_LAMBDA(const int b) {
        double lane_sums[lanes] = {}, sum = 0;
        const int end = n < (b + 1) * block ? n : (b + 1) * block;
        int i = b * block;
        for (; i + lanes <= end; i += lanes)
          for (int l = 0; l < lanes; ++l) lane_sums[l] += static_cast<double>(x(i + l)) * y(i + l);
        for (; i < end; ++i) sum += static_cast<double>(x(i)) * y(i);
        for (int l = 0; l < lanes; ++l) sum += lane_sums[l];
        sums(b) = sum;
      });
  const auto host = Kokkos::create_mirror_view(sums);
  exec.fence();
  Kokkos::deep_copy(host, sums);
  double sum = 0;
  for (int b = 0; b < num_blocks; ++b) sum += host(b);
  return sum;
}

}  // namespace cgcontact
