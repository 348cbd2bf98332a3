#include "recovery/face/face_problem.hpp"

#include <cmath>

#include "core/base/errors/errors.hpp"

namespace cgcontact {
namespace {

using Patches = HalfSpace::Patches;
using Marks = HalfSpace::Marks;

/// Sums two values over all patches, each with its weight (FaceGrid::ring), row by row and the rows in order: the same
/// on any number of threads.
struct Sums {
  double first = 0, second = 0;
};

template <class Exec>
class FaceSolver {
 public:  // compilers of devices take kernels in no others
  FaceSolver(const Exec& exec, const FaceGrid& grid, const HalfSpace& half_space, const Patches& gap, const Marks& seen)
      : exec_(exec),
        rows_(grid.size[0]),
        columns_(grid.size[1]),
        half_space_(half_space),
        gap_(gap),
        seen_(seen),
        ring_(array("cgcontact::face_problem::ring")),
        u_(array("cgcontact::face_problem::displacement")),
        g_(array("cgcontact::face_problem::gap")),
        t_(array("cgcontact::face_problem::direction")),
        r_(array("cgcontact::face_problem::response")),
        before_(array("cgcontact::face_problem::before")),
        sums_("cgcontact::face_problem::sums", grid.size[0], 2) {
    const auto host = Kokkos::create_mirror_view(ring_);
    for (int n = 0; n < grid.num_patches(); ++n) host(n / columns_, n % columns_) = grid.ring(n);
    Kokkos::deep_copy(ring_, host);
  }

  /// The response u = S p follows the steps; it is summed anew after those in which patches have opened or closed.
  FaceSolution solve(double total, double tolerance, int max_iterations, const Patches& p) {
    start(p, total);
    FaceSolution solution;
    double last = 1;
    bool conjugate = false, follows = false;
    Kokkos::deep_copy(exec_, t_, 0.0);
    do {
      if (!follows) half_space_.apply(exec_, p, u_);
      const Sums mean = sum_gap(p);
      const double square = shift_gap(p, mean.second > 0 ? mean.first / mean.second : 0);
      if (!(square > 0)) {
        solution.converged = true;
        break;
      }
      set_direction(p, conjugate ? square / last : 0);
      last = square;
      half_space_.apply(exec_, t_, r_);
      const Sums response = sum_response(p);
      const Sums step = sum_step(p, mean.second > 0 ? response.first / mean.second : 0);
      if (!(step.second > 0)) break;
      const double length = step.first / step.second;
      const Sums changed = take_step(p, length);
      if (!(sum_pressure(p) > 0)) {  // all of one or two patches along a direction that was one for more
        Kokkos::deep_copy(exec_, p, before_);
        conjugate = follows = false;
        ++solution.iterations;
        continue;
      }
      conjugate = changed.first == 0;
      follows = changed.first + changed.second == 0;
      double factor = 1;
      solution.change = scale(p, total, factor);
      if (follows) follow(length, factor);
      ++solution.iterations;
      solution.converged = solution.change <= tolerance;
    } while (!solution.converged && solution.iterations < max_iterations);
    return solution;
  }

  Patches array(const char* label) const { return Patches(std::string(label), rows_, columns_); }

  template <class Term>
  Sums sum(const char* label, const Term& term) const {
    const auto sums = sums_;
    const int columns = columns_;
    Kokkos::parallel_for(
        label, Kokkos::RangePolicy<Exec>(exec_, 0, rows_), KOKKOS_LAMBDA(const int i) {
          double first = 0, second = 0;
          for (int j = 0; j < columns; ++j) term(i, j, first, second);
          sums(i, 0) = first;
          sums(i, 1) = second;
        });
    const auto host = Kokkos::create_mirror_view(sums);
    exec_.fence();
    Kokkos::deep_copy(host, sums);
    Sums all;
    for (int i = 0; i < rows_; ++i) {
      all.first += host(i, 0);
      all.second += host(i, 1);
    }
    return all;
  }

  /// No pressure below zero or where nothing is seen; without any an even one.
  void start(const Patches& p, double total) {
    const auto seen = seen_;
    const Sums given = sum(
        "cgcontact::face_problem::start", KOKKOS_LAMBDA(int i, int j, double& first, double& second) {
          p(i, j) = seen(i, j) && p(i, j) > 0 ? p(i, j) : 0;
          first += p(i, j);
          second += seen(i, j) ? 1 : 0;
        });
    if (!(given.second > 0)) throw InputError("no patch of the contact face sees the other body");
    if (!(given.first > 0))
      sum(
          "cgcontact::face_problem::even",
          KOKKOS_LAMBDA(int i, int j, double&, double&) { p(i, j) = seen(i, j) ? 1 : 0; });
    Kokkos::deep_copy(exec_, before_, p);
    double factor = 1;
    scale(p, total, factor);
  }

  Sums sum_gap(const Patches& p) const {
    const auto u = u_, g = g_, gap = gap_, ring = ring_;
    const auto seen = seen_;
    return sum(
        "cgcontact::face_problem::mean_gap", KOKKOS_LAMBDA(int i, int j, double& first, double& second) {
          g(i, j) = seen(i, j) ? u(i, j) + gap(i, j) : 0;
          if (!(p(i, j) > 0)) return;
          first += ring(i, j) * g(i, j);
          second += ring(i, j);
        });
  }

  double shift_gap(const Patches& p, double mean) const {
    const auto g = g_, ring = ring_;
    return sum(
               "cgcontact::face_problem::shift_gap",
               KOKKOS_LAMBDA(int i, int j, double& first, double&) {
                 g(i, j) -= mean;
                 if (p(i, j) > 0) first += ring(i, j) * g(i, j) * g(i, j);
               })
        .first;
  }

  void set_direction(const Patches& p, double factor) const {
    const auto g = g_, t = t_;
    sum(
        "cgcontact::face_problem::direction",
        KOKKOS_LAMBDA(int i, int j, double&, double&) { t(i, j) = p(i, j) > 0 ? g(i, j) + factor * t(i, j) : 0; });
  }

  Sums sum_response(const Patches& p) const {
    const auto r = r_, ring = ring_;
    return sum(
        "cgcontact::face_problem::mean_response", KOKKOS_LAMBDA(int i, int j, double& first, double&) {
          if (p(i, j) > 0) first += ring(i, j) * r(i, j);
        });
  }

  Sums sum_step(const Patches& p, double mean) const {
    const auto r = r_, t = t_, g = g_, ring = ring_;
    return sum(
        "cgcontact::face_problem::step", KOKKOS_LAMBDA(int i, int j, double& first, double& second) {
          if (!(p(i, j) > 0)) return;
          first += ring(i, j) * g(i, j) * t(i, j);
          second += ring(i, j) * (r(i, j) - mean) * t(i, j);
        });
  }

  /// Returns how many patches without pressure, whose faces would overlap, begin to press, and how many cease.
  Sums take_step(const Patches& p, double length) const {
    const auto t = t_, g = g_, before = before_;
    const auto seen = seen_;
    Kokkos::deep_copy(exec_, before, p);
    return sum(
        "cgcontact::face_problem::take_step", KOKKOS_LAMBDA(int i, int j, double& first, double& second) {
          if (p(i, j) > 0) {
            const double next = p(i, j) - length * t(i, j);
            p(i, j) = next > 0 ? next : 0;
            second += next > 0 ? 0 : 1;
          } else if (seen(i, j) && g(i, j) < 0) {
            p(i, j) = -length * g(i, j);
            first += 1;
          }
        });
  }

  double sum_pressure(const Patches& p) const {
    const auto ring = ring_;
    return sum(
               "cgcontact::face_problem::total",
               KOKKOS_LAMBDA(int i, int j, double& first, double&) { first += ring(i, j) * p(i, j); })
        .first;
  }

  /// To the given sum, times `factor`; returns how much changed since `before_`.
  double scale(const Patches& p, double total, double& factor) const {
    const double now = sum_pressure(p);
    factor = now > 0 ? total / now : 0;
    const auto before = before_, ring = ring_;
    const double by = factor;
    const Sums change = sum(
        "cgcontact::face_problem::scale", KOKKOS_LAMBDA(int i, int j, double& first, double&) {
          p(i, j) *= by;
          first += ring(i, j) * (p(i, j) > before(i, j) ? p(i, j) - before(i, j) : before(i, j) - p(i, j));
        });
    return total > 0 ? change.first / total : 0;
  }

  /// The response to what p has become without patches that open or close.
  void follow(double length, double factor) const {
    const auto u = u_, r = r_;
    sum(
        "cgcontact::face_problem::follow",
        KOKKOS_LAMBDA(int i, int j, double&, double&) { u(i, j) = factor * (u(i, j) - length * r(i, j)); });
  }

 private:
  Exec exec_;
  int rows_, columns_;
  const HalfSpace& half_space_;
  Patches gap_;
  Marks seen_;
  Patches ring_, u_, g_, t_, r_, before_;
  Patches sums_;
};

}  // namespace

template <class Exec>
FaceSolution solve_face_problem(const Exec& exec, const FaceGrid& grid, const HalfSpace& half_space, const Patches& gap,
                                const Marks& seen, double force, double tolerance, int max_iterations,
                                const Patches& p) {
  return FaceSolver<Exec>(exec, grid, half_space, gap, seen).solve(force / grid.area(), tolerance, max_iterations, p);
}

template FaceSolution solve_face_problem(const ExecSpace&, const FaceGrid&, const HalfSpace&, const Patches&,
                                         const Marks&, double, double, int, const Patches&);

}  // namespace cgcontact
