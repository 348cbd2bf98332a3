/// The recovered stresses of a solution: plain SPR of each body, the problems on the contact faces, SPR-C.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Sets SolvedState::spr, sprc, faces, recovery_counts and patch_states, and the contact links of the
/// bodies, from the displacements and forces of the state. Returns warnings. exec: what the problems on the faces run
/// on.
std::vector<std::string> recover_stresses(const ExecSpace& exec, SolvedState& state);

}  // namespace cgcontact
