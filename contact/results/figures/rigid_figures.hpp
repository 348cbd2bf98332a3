/// Motions of rigid bodies, and the moments that act on them.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets BodyFields::rigid of all rigid bodies.
void set_rigid_figures(const SolvedState& state, const std::vector<PairFigures>& pairs,
                       std::vector<BodyFields>& bodies);

}  // namespace cgcontact
