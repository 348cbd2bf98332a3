/// Kernels of fit_batch for any Kokkos execution space; `Real`: double, or eight lanes on the host. The patches, their
/// rows and the statuses lie in memory that the space can reach.
#pragma once

#include "recovery/batched/batched_fit_kernel.hpp"

namespace cgcontact {

template <class Real, class Exec, int degree, int bodies>
class FitDispatch {
 public:  // all functions with kernels: compilers of devices take them in no others
  using Kernel = FitKernel<Real, degree, bodies>;
  using Input = FitInput<degree, bodies>;
  using Numbers = Kokkos::View<int*, typename Exec::memory_space>;
  static constexpr int lanes = Kernel::lanes;

  FitDispatch(const Exec& exec, Input* patches, FitStatus* status, double tolerance)
      : exec_(exec), patches_(patches), status_(status), tolerance_(tolerance) {}

  /// Solves all by Cholesky, then those left by the pseudo-inverse in batches of their own.
  void run(int n) const {
    const Numbers order(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::batched_fit::order"), n);
    const Numbers left("cgcontact::batched_fit::left", n);
    const int max_rows = sort(order);
    solve(order, n, max_rows, Kernel::Solver::cholesky, left);
    const int num_left = keep_left(order, left);
    if (num_left > 0) solve(order, num_left, max_rows, Kernel::Solver::spectral, left);
    exec_.fence();
  }

  /// Sorts the patches by the number of their rows, so that the lanes of a batch carry equal numbers. Returns the
  /// largest number of rows.
  int sort(const Numbers& order) const {
    const Input* const patches = patches_;
    const int n = static_cast<int>(order.extent(0));
    int most = 0;
    Kokkos::parallel_reduce(
        "cgcontact::batched_fit::most_rows", Kokkos::RangePolicy<Exec>(exec_, 0, n),
        KOKKOS_LAMBDA(const int i, int& largest) {
          largest = patches[i].num_rows > largest ? patches[i].num_rows : largest;
        },
        Kokkos::Max<int>(most));
    const Numbers offset("cgcontact::batched_fit::place", most + 1);
    Kokkos::parallel_for(
        "cgcontact::batched_fit::count_rows", Kokkos::RangePolicy<Exec>(exec_, 0, n),
        KOKKOS_LAMBDA(const int i) { Kokkos::atomic_increment(&offset(patches[i].num_rows)); });
    Kokkos::parallel_scan(
        "cgcontact::batched_fit::places", Kokkos::RangePolicy<Exec>(exec_, 0, most + 1),
        KOKKOS_LAMBDA(const int rows, int& sum, const bool is_final) {
          const int count = offset(rows);
          if (is_final) offset(rows) = sum;
          sum += count;
        });
    Kokkos::parallel_for(
        "cgcontact::batched_fit::sort", Kokkos::RangePolicy<Exec>(exec_, 0, n),
        KOKKOS_LAMBDA(const int i) { order(Kokkos::atomic_fetch_add(&offset(patches[i].num_rows), 1)) = i; });
    return most;
  }

  using Policy = Kokkos::TeamPolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
  using Solver = typename Kernel::Solver;
  /// Vectors of the processor begin at such addresses.
  static constexpr std::size_t alignment = 64;

  /// Solves one batch; marks the patches that the solver left.
  static KOKKOS_INLINE_FUNCTION void solve_batch(Input* patches, FitStatus* status, double tolerance, Solver solver,
                                                 const Numbers& order, int n, int begin, Real* scratch,
                                                 const Numbers& left) {
    const int used = n - begin < lanes ? n - begin : lanes;
    Input* patch[lanes];
    FitStatus* to[lanes];
    bool unsolved[lanes];
    for (int l = 0; l < lanes; ++l) {
      const int i = order(begin + (l < used ? l : used - 1));
      patch[l] = patches + i;
      to[l] = status + i;
    }
    Kernel::run(patch, to, used, tolerance, solver, scratch, unsolved);
    for (int l = 0; l < used; ++l) left(order(begin + l)) = unsolved[l];
  }

  /// Solves in batches. A batch is a team; its work space is the team's scratch memory, and where that is too small,
  /// for hundreds of rows, a view that the batches use in turn.
  void solve(const Numbers& order, int n, int max_rows, Solver solver, const Numbers& left) const {
    Input* const patches = patches_;
    FitStatus* const status = status_;
    const double tolerance = tolerance_;
    const int num_batches = (n + lanes - 1) / lanes;
    const std::size_t bytes = Kernel::scratch_size(max_rows) * sizeof(Real) + alignment;
    if (bytes <= static_cast<std::size_t>(Policy::scratch_size_max(1))) {
      Policy policy(exec_, num_batches, 1);
      policy.set_scratch_size(1, Kokkos::PerTeam(static_cast<int>(bytes)));
      Kokkos::parallel_for(
          "cgcontact::batched_fit::fit", policy, KOKKOS_LAMBDA(const typename Policy::member_type& team) {
            Real* const scratch = static_cast<Real*>(
                team.team_scratch(1).get_shmem_aligned(static_cast<std::ptrdiff_t>(bytes - alignment), alignment));
            solve_batch(patches, status, tolerance, solver, order, n, team.league_rank() * lanes, scratch, left);
          });
      return;
    }
    const Kokkos::View<char*, typename Exec::memory_space> memory(
        Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::batched_fit::scratch"), bytes);
    Real* const scratch = reinterpret_cast<Real*>((reinterpret_cast<std::uintptr_t>(memory.data()) + alignment - 1) /
                                                  alignment * alignment);
    Kokkos::parallel_for(
        "cgcontact::batched_fit::fit_large", Kokkos::RangePolicy<Exec>(exec_, 0, 1), KOKKOS_LAMBDA(const int) {
          for (int batch = 0; batch < num_batches; ++batch)
            solve_batch(patches, status, tolerance, solver, order, n, batch * lanes, scratch, left);
        });
  }

  /// Keeps the marked numbers in `order`, in their order; returns how many there are.
  int keep_left(const Numbers& order, const Numbers& left) const {
    const int n = static_cast<int>(order.extent(0));
    const Numbers all("cgcontact::batched_fit::all", n);
    Kokkos::deep_copy(exec_, all, order);
    int count = 0;
    Kokkos::parallel_scan(
        "cgcontact::batched_fit::left", Kokkos::RangePolicy<Exec>(exec_, 0, n),
        KOKKOS_LAMBDA(const int k, int& sum, const bool is_final) {
          const bool kept = left(all(k)) != 0;
          if (is_final && kept) order(sum) = all(k);
          sum += kept;
        },
        count);
    return count;
  }

 private:
  Exec exec_;
  Input* patches_;
  FitStatus* status_;
  double tolerance_;
};

/// Runs fit_batch with a patch in each lane of `Real`.
template <class Real, class Exec, int degree, int bodies>
void dispatch_fits(const Exec& exec, FitInput<degree, bodies>* patches, int n, double rank_tolerance,
                   FitStatus* status) {
  if (n > 0) FitDispatch<Real, Exec, degree, bodies>(exec, patches, status, rank_tolerance).run(n);
}

}  // namespace cgcontact
