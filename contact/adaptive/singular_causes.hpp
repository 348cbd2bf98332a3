/// What can make a stress infinite: re-entrant edges, ends of supports and bonds, edges of bodies that press.
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Is there one within `radius` (m) of x on the boundary of a body? On a smooth face without an end of anything the
/// stress is finite, whatever it looks like on a few grids.
bool has_cause_of_singularity(const SolvedState& state, int body, const Vec3& x, double radius);

}  // namespace cgcontact
