/// Motions of rigid bodies, and the moments that act on them.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Fills BodyFields::rigid of all rigid bodies. Needs the bodies and the forces of the pairs.
void fill_rigid_figures(const SolvedState& state, Results& results);

}  // namespace cgcontact
