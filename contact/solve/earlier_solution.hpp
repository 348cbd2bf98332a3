/// The outer iteration starts from the solution on other grids.
#pragma once

#include "contact/solve/iterate.hpp"
#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Sets the lagged stress at supports and contact (the earlier recovered stress there), the contact points' state
/// (closed where that presses), and the rigid parts of the bodies. Same scene, other cells. False: the earlier solution
/// presses nowhere, nothing is changed.
bool start_from(const SolvedState& earlier, Iterate& iterate);

}  // namespace cgcontact
