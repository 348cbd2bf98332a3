/// The outer iteration starts from the solution on other grids.
#pragma once

namespace cgcontact {

struct Iterate;
struct SolvedState;

/// Sets the lagged stress at supports and contact (the earlier recovered stress there), the contact points' state
/// (closed where that presses), and the rigid motions of the bodies. Same scene, other cells, on which the contact
/// zones are resolved. False, and nothing changed: the earlier solution presses nowhere.
bool start_from(const SolvedState& earlier, Iterate& iterate);

}  // namespace cgcontact
