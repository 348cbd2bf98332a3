/// Check of the result against the limits of small strain and small sliding.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Returns one warning for each body whose strain, displacement or contact pressure is too large, with the largest
/// value and its position. Limits: principal strain 5 %, displacement 10 % of the body, contact pressure a tenth of E.
std::vector<std::string> small_strain_warnings(const SolvedState& state, const std::vector<ContactRow>& rows);

/// Returns "", or that a body is strained by more than 100 % and moves farther than it is long: on any grid these are
/// not the intended loads.
std::string beyond_all_grids(const SolvedState& state);

}  // namespace cgcontact
