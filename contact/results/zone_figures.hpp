/// Force, moments, extents of the contact zone of every pair, and Hertz's answer beside them.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets PairFigures::zone of all pairs. Needs their other figures, scaled to the thickness of the bodies.
void fill_zone_figures(const SolvedState& state, Results& results);

}  // namespace cgcontact
