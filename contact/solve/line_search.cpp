#include "contact/solve/line_search.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

constexpr int most_bisections = 30;
/// DoFs per chunk of the parallel loops.
constexpr std::size_t grain = 4096;

/// A contact group along the step.
struct GroupOnStep {
  const ContactPair* pair;
  const ContactGroup* group;
  std::size_t pair_number;
  double gap, gap_change;  // at the beginning, along the step, m
};

std::vector<GroupOnStep> groups_on_step(const Iterate& iterate, const RealView& before, const RealView& step) {
  const OuterProblem& problem = iterate.problem;
  const double length = problem.scales.length;
  std::vector<GroupOnStep> groups;
  for (const ContactPair& pair : problem.pairs)
    for (const ContactGroup& group : pair.groups) {
      double at_start = 0, along = 0;
      // Their energy is in the system's as it is.
      const bool linear = pair.bonded() || iterate.small_zones.has(groups.size());
      for (const auto& [dof, value] : problem.system.group_rows[groups.size()].entries) {
        if (linear) break;
        at_start += value * before(dof);
        along += value * step(dof);
      }
      groups.push_back({&pair, &group, static_cast<std::size_t>(&pair - problem.pairs.data()),
                        group.initial_gap + iterate.rigid_gap_change[groups.size()] + at_start * length,
                        along * length});
    }
  return groups;
}

/// Of the energy along the step, at its part t; system units. curvature: of the energy with the closed contact.
double slope_of_energy(const Iterate& iterate, const std::vector<GroupOnStep>& groups, double curvature, double t) {
  double sum = -curvature * (1 - t);
  for (const GroupOnStep& g : groups) {
    if (g.gap_change == 0) continue;
    const NormalContact law = g.pair->law(*g.group);
    double more = 0;  // force of all points that press less that of those taken for closed
    for (int q = g.group->first_point; q < g.group->last_point; ++q) {
      const double closed = law.closed_pressure(
          iterate.contact_stress[g.pair_number][q] * iterate.problem.scales.stress, g.gap + t * g.gap_change);
      more +=
          g.pair->points.weight(q) * ((law.is_closed(closed) ? closed : 0) - (g.pair->points.active(q) ? closed : 0));
    }
    sum -= more / iterate.force_unit() * g.gap_change / iterate.problem.scales.length;
  }
  return sum;
}

}  // namespace

double search_along_step(const LinearSolver& solver, const RealView& before, Iterate& iterate) {
  const RealView& u = iterate.u;
  const RealView step("cgcontact::line_search::step", u.size());
  parallel_for("cgcontact::line_search::step", u.size(), grain, [&](std::size_t i) { step(i) = u(i) - before(i); });
  const double curvature = solver.energy(step);
  const std::vector<GroupOnStep> groups = groups_on_step(iterate, before, step);
  const auto slope = [&](double t) { return slope_of_energy(iterate, groups, curvature, t); };
  if (slope(1) <= 0) return 1;
  double low = 0, high = 1;
  for (int k = 0; k < most_bisections; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) <= 0 ? low : high) = middle;
  }
  parallel_for("cgcontact::line_search::go_along_step", u.size(), grain,
               [&](std::size_t i) { u(i) = before(i) + high * step(i); });
  return high;
}

}  // namespace cgcontact
