#include "contact/solve/active_set.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Closes all points whose gap is not positive and, where a pair has none, those whose gap is larger than its smallest
/// one by no more than `allowance` of the smaller cell. Returns whether all points are closed.
bool close_near_the_smallest_gap(const OuterProblem& problem, double allowance) {
  bool all = true;
  for (ContactPair& pair : problem.pairs) {
    if (pair.bonded()) continue;
    double smallest = 1e300, h = 1e300;
    for (const ContactGroup& g : pair.groups) {
      smallest = std::min(smallest, g.initial_gap);
      h = std::min(h, g.h);
    }
    const double limit = std::max(smallest + allowance * h, 1e-9 * h);
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      const bool closed = pair.groups[pair.points.group(q)].initial_gap <= limit;
      pair.points.set_active(q, closed);
      all &= closed;
    }
  }
  return all;
}

}  // namespace

void initialise_active_set(Iterate& iterate) {
  const OuterProblem& problem = iterate.problem;
  if (iterate.floating.any() && close_where_rigid_bodies_meet(problem.bodies, problem.supports, problem.pairs)) return;
  for (double allowance = 0.02; !close_near_the_smallest_gap(problem, allowance) && !driven_motions(problem).empty();
       allowance *= 4) {
  }
}

void close_pressing_points(Iterate& iterate) {
  const OuterProblem& problem = iterate.problem;
  const double moved = iterate.body_motions.largest_displacement(problem.exec, iterate.u) * problem.scales.length;
  iterate.close_pressing_points(no_force * moved);
}

void update_active_set(Iterate& iterate, bool decide) {
  close_pressing_points(iterate);
  std::vector<double> force = iterate.group_force(true);
  for (double& f : force) f *= iterate.force_unit();
  iterate.small_zones.update(iterate.group_gap_change(), force, decide);
}

std::vector<std::string> open_separating_pairs(Iterate& iterate, const FreeMotions& unbalanced) {
  const std::vector<char> open = iterate.floating.pairs_that_open(unbalanced);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (!open[k]) continue;
    names.push_back('"' + iterate.problem.pairs[k].spec->name + '"');
    ContactPoints& points = iterate.problem.pairs[k].points;
    for (std::size_t q = 0; q < points.size(); ++q) points.set_active(q, false);
  }
  return names;
}

long long count_active(const std::vector<ContactPair>& pairs) {
  long long active = 0;
  for (const ContactPair& pair : pairs)
    for (std::size_t q = 0; q < pair.num_surface_points(); ++q) active += pair.points.active(q);
  return active;
}

FreeMotions driven_motions(const OuterProblem& problem, double no_stiffness) {
  const FreeMotions free = find_free_motions(problem.bodies, problem.supports, problem.pairs, no_stiffness);
  return free.empty() ? free : driven_by_loads(free, problem.bodies);
}

}  // namespace cgcontact
