/// Supports and loads of the bodies, with resultants, as lists for the report.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Returns the figures of all loads on faces, then on volumes (N, m^2; as they act in the last step, of the whole
/// thickness).
std::vector<LoadFigures> load_figures(const Scene& scene, const std::vector<BodyModel>& bodies);

/// Sets conditions and areas of Results::supports, the interference of every pair, and BodyFields::contact_of_point;
/// supports, pairs and bodies must be there.
void fill_conditions(const SolvedState& state, Results& results);

}  // namespace cgcontact
