/// Lines on the contact faces along which the pressure is drawn.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets Results::path. With a path in the scene: 401 places of that line, projected to the faces of every body. Without
/// one, for every pair a line that follows the face through the largest pressure, along the coordinate axis (or else
/// the main direction) in which the contact zone is longest, a little beyond the zone at both ends; s is zero at the
/// largest pressure. Pairs without pressure have none.
void fill_paths(const SolvedState& state, Results& results);

}  // namespace cgcontact
