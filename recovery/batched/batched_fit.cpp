#include "recovery/batched/batched_fit.hpp"

#include <algorithm>
#include <memory>
#include <new>
#include <vector>

#include "recovery/batched/batched_fit_kernel.hpp"

namespace cgcontact {
namespace {

/// Work space of this thread, for every kind of fit; it stays allocated: 0.1 MB for 12 rows, 0.5 for 36, 1.8 for
/// 72, 6.5 for 144, most of it for the rotations of pseudo_inverse_solve.
Vector<double>* thread_scratch(std::size_t size) {
  struct Free {
    void operator()(Vector<double>* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  thread_local std::unique_ptr<Vector<double>, Free> scratch;
  thread_local std::size_t capacity = 0;
  if (size > capacity) {
    scratch.reset(static_cast<Vector<double>*>(::operator new[](size * sizeof(Vector<double>), std::align_val_t{64})));
    capacity = size;
  }
  return scratch.get();
}

/// Patches in the order of their rows, so that the lanes of a batch carry equal numbers of them.
template <int degree, int bodies>
class Batches {
 public:
  using Kernel = FitKernel<Vector<double>, degree, bodies>;
  using Input = FitInput<degree, bodies>;
  static constexpr int lanes = Kernel::lanes;

  Batches(Input* patches, FitStatus* status, double tolerance)
      : patches_(patches), status_(status), tolerance_(tolerance) {}

  void sort(std::vector<int>& order) const {
    std::sort(order.begin(), order.end(), [this](int i, int j) {
      const int a = patches_[i].num_rows, b = patches_[j].num_rows;
      return a != b ? a < b : i < j;
    });
  }

  /// The batch that begins at order[begin]; marks the patches that the solver left.
  void run(const std::vector<int>& order, std::size_t begin, typename Kernel::Solver solver, char* left) const {
    const int used = static_cast<int>(std::min<std::size_t>(lanes, order.size() - begin));
    Input* patch[lanes];
    FitStatus* status[lanes];
    bool unsolved[lanes];
    for (int l = 0; l < lanes; ++l) {
      const int i = order[begin + std::min(l, used - 1)];
      patch[l] = patches_ + i;
      status[l] = status_ + i;
    }
    Kernel::run(patch, status, used, tolerance_, solver,
                thread_scratch(Kernel::scratch_size(patch[lanes - 1]->num_rows)), unsolved);
    for (int l = 0; l < used; ++l) left[order[begin + l]] = unsolved[l];
  }

  /// for_each(number of batches, body(batch)): Cholesky for all, then those left in batches of their own.
  template <class ForEach>
  void run_all(int n, const ForEach& for_each) const {
    thread_local std::vector<int> order;
    thread_local std::vector<char> left;
    order.resize(n);
    left.assign(n, 0);
    for (int i = 0; i < n; ++i) order[i] = i;
    sort(order);
    for (const auto solver : {Kernel::Solver::cholesky, Kernel::Solver::spectral}) {
      // References for other threads: `order` of this thread, not theirs.
      const std::vector<int>& of_all = order;
      char* marks = left.data();
      const int count = (static_cast<int>(order.size()) + lanes - 1) / lanes;
      for_each(count, [&, this](int batch) { run(of_all, static_cast<std::size_t>(batch) * lanes, solver, marks); });
      order.erase(std::remove_if(order.begin(), order.end(), [&](int i) { return !left[i]; }), order.end());
    }
  }

 private:
  Input* patches_;
  FitStatus* status_;
  double tolerance_;
};

}  // namespace

template <int degree, int bodies>
void fit_patches(FitInput<degree, bodies>* patches, int n, double rank_tolerance, FitStatus* status) {
  const Batches<degree, bodies> batches(patches, status, rank_tolerance);
  batches.run_all(n, [](int count, const auto& body) {
    for (int i = 0; i < count; ++i) body(i);
  });
}

template <class Exec, int degree, int bodies>
void fit_batch(const Exec& exec, FitInput<degree, bodies>* patches, int n, double rank_tolerance, FitStatus* status) {
  const Batches<degree, bodies> batches(patches, status, rank_tolerance);
  batches.run_all(n, [&exec](int count, const auto& body) {
    Kokkos::parallel_for("cgcontact::batched_fit",
                         Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>(exec, 0, count),
                         [&](int i) { body(i); });
    exec.fence();
  });
}

double fit_flop(int degree, int bodies, int num_rows, bool truncated) {
  const double T = degree == 1 ? 4 : 10, interior = degree == 1 ? 3 : 18, B = bodies, m = num_rows;
  const double n = B * interior + m;                                            // all rows
  const double product = degree == 1 ? 6 : 81, entries = degree == 1 ? 9 : 63;  // C a and entries of the interior rows
  const double mass = T * T * T;                                                // factor, its inverse, m^-1: 1/3 each
  const double terms = degree == 1 ? 0 : 6;
  // Terms, whitening, lengths, normalising; then L^-T y and products with the interior rows.
  const double rows = B * (terms + T * T + 2 * T + 12 + 7) + B * (T * T + 2 * product + interior);
  const double pairs = 0.5 * m * (m - 1) * B * (2 * 6 + 2 * T + 2) + B * (entries * 2 * T + interior * product);
  const double bound = 4 * n * n;
  // Residuals before and after, the correction, and what belongs to the bodies there.
  const double apply = m * B * (2 * (terms + 12 * T + 12) + terms + 13 * T);
  const double body = B * (2 * product + 2 * entries + 6 * (2 * T * T + T) + 6 * (T * T + 2 * T));
  // Two Cholesky factors, or one and the eigenvalues.
  const double solve = truncated ? 5 * n * n * n / 3 + 30 * n * n : 2 * n * n * n / 3 + 2 * n * n;
  return B * mass + m * rows + pairs + bound + apply + body + solve;
}

#define CGCONTACT_FIT(degree, bodies)                                            \
  template void fit_patches(FitInput<degree, bodies>*, int, double, FitStatus*); \
  template void fit_batch(const Kokkos::DefaultHostExecutionSpace&, FitInput<degree, bodies>*, int, double, FitStatus*);
CGCONTACT_FIT(1, 1)
CGCONTACT_FIT(1, 2)
CGCONTACT_FIT(2, 1)
CGCONTACT_FIT(2, 2)
#undef CGCONTACT_FIT

}  // namespace cgcontact
