/// Displacements that targets of [accuracy] name, and how far they may be off.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Returns one displacement for each such target of Scene::accuracy, m: the mean over a face or over the points of a
/// probe; of the largest displacement its size along x. Zero where no body holds a point.
std::vector<Vec3> named_displacements(const SolvedState& state);

/// One solve as far as displacements go.
struct DisplacementState {
  std::vector<Vec3> values;  ///< m, named_displacements; empty: there was no such solve
  double energy_error = 0;   ///< relative, of the energy norm
  double held = 0;           ///< held_force_fraction
};

/// Returns their relative errors: the larger one of
/// - twice the square of the energy norm's error, which is the error of the displacement that the loads do their work
///   on (twice, as the force's: pressure_estimate.hpp),
/// - with an earlier solve, the change since then times r/(1-r), errors falling by r = the ratio of those squares, at
///   most 3/4,
/// and what holdings take of the contact forces.
std::vector<double> displacement_errors(const DisplacementState& now, const DisplacementState& before);

}  // namespace cgcontact
