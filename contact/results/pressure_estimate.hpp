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
/// - the change of the edge's square-root term when the edge moves by the error of its position: the other two hardly
///   see it;
/// - the pressure times the square of the relative error of the energy norm: what is wrong with the solution's forces;
/// - in zones of less than four cells the difference to the pressure of plain SPR: all the others look
///   for errors that are small, and SPR-C may be no better than SPR there.
/// Where the pressure is that of a problem on the face (recovery/face/face_zone.hpp) it is what that problem says of
/// itself, at the force of the run, whose own estimate stands beside it (PairFigures::force_error_of_pressure); where
/// the zone is not resolved with the difference to plain SPR. The pair's pressure estimate is the L2 norm of that
/// relative to that of the pressure. The force is exact where the loads give it; where the zone is not resolved it has
/// no estimate. Else its estimate is the square of the relative error of the energy norm: the force is a functional of
/// the solution, and its error the product of that of the solution and that of a dual problem; under prescribed
/// displacements alone the two are the same. Twice that where the zone ends inside the faces. Needs the contact rows
/// with pressure_opposite and pressure_transmitted, the verdict, and estimated_error_relative.
void estimate_contact_errors(const SolvedState& state, Results& results);

}  // namespace cgcontact
