#include "contact/results/estimates/open_force.hpp"

#include "contact/motions/statics.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/verdict/verdict.hpp"

namespace cgcontact {
namespace {

/// normal: sum of what the pair's points press, N.
double fraction_of(const SolvedState& state, std::size_t pair, double normal, const PairFigures& figures, bool given) {
  if (is_tightened(state, pair)) return 0;
  const double force = figures.force_on_first.norm();
  if (force > 0 && !given) return 1;
  const double balanced = normal > 0 && !state.pairs[pair].bonded() ? 1 - force / normal : 0;
  return balanced > relevant_force_fraction ? balanced : 0;
}

}  // namespace

bool is_tightened(const SolvedState& state, std::size_t pair) {
  return state.pairs[pair].spec->preload && state.scene.steps.size() < 2;
}

std::vector<OpenForce> open_forces(const SolvedState& state, const std::vector<PairFigures>& figures) {
  const Statics statics(state.scene, state.bodies, state.supports, state.pairs);
  const std::vector<double> normal = normal_forces(state);
  std::vector<OpenForce> forces(state.pairs.size());
  for (std::size_t p = 0; p < forces.size(); ++p) {
    if (figures[p].active_points == 0) continue;
    const Vec3& force = figures[p].force_on_first;
    forces[p].given_by_loads = force.norm() > 0 && statics.loads_give(static_cast<int>(p), force.normalized());
    forces[p].fraction = fraction_of(state, p, normal[p], figures[p], forces[p].given_by_loads);
  }
  return forces;
}

}  // namespace cgcontact
