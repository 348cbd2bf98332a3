/// What holds and loads the bodies, with resultants, as lists for the report.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets Results::loads (N, m^2; as they act in the last step), conditions and areas of Results::supports (which must be
/// there), the interference of every pair, and BodyFields::contact_of_point.
void fill_conditions(const SolvedState& state, Results& results);

}  // namespace cgcontact
