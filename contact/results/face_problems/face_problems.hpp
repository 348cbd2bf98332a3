/// From a solved scene to the problems on its contact faces, one for each zone (recovery/face/face_zone.hpp).
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Solves the problems of the faces. Needs the solution; bonded pairs have none.
FacePressures solve_face_pressures(const ExecSpace& exec, const SolvedState& state);

}  // namespace cgcontact
