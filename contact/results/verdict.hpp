/// What a run says of itself first of all: is its contact resolved, and if not, which cells would do?
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Cells across a zone below which neither its pressure nor the estimate of its error can be relied on, and those that
/// are recommended (five over half the width, or the radius). Evidence: docs/recovery.md, "Error figures".
constexpr double least_cells_across = 5, wanted_cells_across = 10;

/// Needs the pair figures, contact rows and contact links of the last recovery.
Verdict judge(const SolvedState& state, const Results& results);

}  // namespace cgcontact
