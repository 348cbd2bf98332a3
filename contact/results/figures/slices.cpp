#include "contact/results/figures/slices.hpp"

#include <cmath>

namespace cgcontact {
namespace {

void scale(std::vector<PairFigures>& pairs, double factor) {
  for (PairFigures& pair : pairs) {
    for (Vec3* v : {&pair.force_on_first, &pair.force_on_second, &pair.moment_on_first, &pair.moment_on_second})
      *v *= factor;
    pair.area *= factor;
  }
}

}  // namespace

void scale_to_thickness(const SolvedState& state, Results& results) {
  const double factor = state.bodies.front().slices;  // of all bodies: check_slices
  if (factor == 1) return;
  scale(results.pairs, factor);
  for (StepFigures& step : results.steps) scale(step.pairs, factor);
  for (std::size_t s = 0; s < results.supports.size(); ++s) {
    if (state.scene.supports[s].implied) continue;
    results.supports[s].force *= factor;
    results.supports[s].moment *= factor;
    results.supports[s].area *= factor;
  }
  for (BodyBalance& balance : results.balance)
    for (Vec3* v : {&balance.loads, &balance.supports, &balance.contact, &balance.holds}) *v *= factor;
  for (ContactRow& row : results.contact_rows) row.weight *= factor;
  const double of_norms = std::sqrt(factor);
  results.estimated_error *= of_norms;
  results.exact_error *= of_norms;
  for (BodyFields& body : results.bodies) {
    for (double& error : body.error_of_cell) error *= of_norms;
    for (double& energy : body.energy_of_cell) energy *= factor;
  }
}

}  // namespace cgcontact
