#include "contact/solve/line_search.hpp"

#include "kernels/mesh/dot.hpp"

namespace cgcontact {
namespace {

constexpr int max_interval_bisections = 30;
constexpr int max_halvings_with_friction = 60;
/// Relative tolerance of the length with friction, whose rigid motions may overshoot where a body is held again.
constexpr double length_error = 1e-3;
/// Fraction of the slope at the start of the step that may be left at its end.
constexpr double slope_left = 1e-3;

}  // namespace

double search_along_step(const LinearSolver& solver, const RealView& before, Iterate& iterate) {
  const OuterProblem& problem = iterate.problem;
  const ExecSpace& exec = problem.exec;
  const RealView& u = iterate.u;
  const int n = static_cast<int>(u.size());
  const RealView step("cgcontact::line_search::step", n);
  Kokkos::parallel_for(
      "cgcontact::line_search::step", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
      KOKKOS_LAMBDA(const int i) { step(i) = u(i) - before(i); });
  exec.fence();
  const double curvature = solver.energy(step);
  const Friction& friction = iterate.friction;
  const ContactGroupArrays<MemSpace>& groups = iterate.groups();
  const RealView along = iterate.gap_change_of(step), start = iterate.gap_change(),
                 excess("cgcontact::line_search::excess", along.size());
  Kokkos::parallel_for(
      "cgcontact::line_search::start", Kokkos::RangePolicy<ExecSpace>(exec, 0, static_cast<int>(along.size())),
      KOKKOS_LAMBDA(const int g) { start(g) -= along(g); });
  // Slope of the energy at the fraction t of the step; system units. curvature: of the energy with the closed contact.
  const auto slope = [&](double t) {
    excess_forces(exec, groups, start, along, t, excess);
    friction.add_excess(groups, start, along, t, excess);
    return -curvature * (1 - t) - dot(exec, excess, along) / (iterate.force_unit() * problem.scales.length);
  };
  if (curvature <= 0) return 1;  // mu p that follows the gap may turn it: no energy, no search
  if (slope(1) <= (friction.any() ? slope_left * curvature : 0)) return 1;
  double low = 0, high = 1;
  const int most = friction.any() ? max_halvings_with_friction : max_interval_bisections;
  for (int k = 0; k < most && !(friction.any() && high - low < length_error * high); ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) <= 0 ? low : high) = middle;
  }
  Kokkos::parallel_for(
      "cgcontact::line_search::go_along_step", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
      KOKKOS_LAMBDA(const int i) { u(i) = before(i) + high * step(i); });
  exec.fence();
  return high;
}

}  // namespace cgcontact
