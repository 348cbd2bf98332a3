/// Estimated errors of the recovered contact pressure and the contact force, from the solution alone. Evidence:
/// docs/recovery.md, "Error figures".
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets ContactRow::pressure_error of all contact rows, and the estimates of every pair. Per row the root of the sum of
/// the squares of
/// - half of the jump between the two bodies' pressures: what is wrong with their difference;
/// - the local mean of the transmitted less the recovered pressure (the multipliers are in equilibrium with the
///   solution, their scatter averages out): what is wrong with the mean of both bodies. Points near an edge of the
///   zone, where the transmitted pressure itself is spoilt, take the mean of those farther inside;
/// - the pressure times the square of the relative error of the energy norm: what is wrong with the solution's forces;
/// - where closed and open points are within ResultOptions::spoilt_at_edge cells the difference to the pressure of
///   plain SPR: how contact ends, which no polynomial follows.
/// Rows with nothing opposite, farther than a cell from what touches, have no error.
/// Where the pressure is that of a problem on the face (recovery/face/face_zone.hpp) it is what that problem says of
/// itself, at the force of the run, whose own estimate stands beside it (PairFigures::force_error_of_pressure); where
/// the zone is not resolved with the difference to plain SPR. The pair's pressure estimate is the L2 norm of that
/// relative to that of the pressure. The force is exact where loads or preload give it; where the zone is not resolved
/// it has no estimate. Else its estimate is the square of the relative error of the energy norm (the force is a
/// functional of the solution, and its error the product of that of the solution and that of a dual problem; under
/// prescribed displacements alone the two are the same) plus the work of the pressure on the gaps that are left between
/// closed points, over twice the strain energy; the first times the norm of the solution over that of the pair's own
/// contact, the second times its square (loads beside the contact). Twice that where the zone ends inside the faces.
/// What holds bodies that nothing else holds, and forces that do not balance, count as errors of pressure and force as
/// well. Needs the contact rows with pressure_opposite and pressure_transmitted, the verdict, and
/// estimated_error_relative.
void estimate_contact_errors(const SolvedState& state, Results& results);

}  // namespace cgcontact
