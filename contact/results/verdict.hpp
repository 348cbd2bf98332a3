/// What a run says of itself first of all: is its contact resolved, and if not, which cells would do?
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Needs the pair figures, contact rows and contact links of the last recovery.
Verdict judge(const SolvedState& state, const Results& results);

}  // namespace cgcontact
