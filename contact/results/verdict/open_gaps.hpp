/// Faces that nothing presses: check whether the gap that is left exceeds the error of the displacements.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets the smallest gap and its estimated error of every pair without contact, and the deepest overlap of pairs that
/// miss contact beside closed points; bodies: with the errors of their cells.
///
/// The error of a displacement goes with the square of that of the energy norm: for the load's own exactly, for that of
/// a unit force at the gap as far as the cells resolve both equally well. So the error of the gap is the sum over both
/// bodies of eta^2 times the largest displacement by which they deform, times a safety factor.
void estimate_gap_errors(const SolvedState& state, const std::vector<ContactRow>& rows,
                         const std::vector<BodyFields>& bodies, std::vector<PairFigures>& pairs);

/// A pair that nothing presses although its faces may touch, as far as the displacements are known.
struct UnclearGap {
  int pair = 0;
  double gap = 0, error = 0;  ///< m
  Vec3 x = Vec3::Zero();      ///< m: where it is smallest
  double cell = 0;            ///< m, size of the larger cell there
  double force = 0;           ///< N: of a flat punch as wide as a cell under an overlap of the error less the gap
};

/// Returns the factor of the cells, and so of the error of the energy norm, that brings the error of a gap down to the
/// gap, or to a tenth of itself where the gap is less: cells a third as large are worth a try.
double refinement_to_tell(double gap, double error);

/// Returns one for each pair without contact whose smallest gap is not larger than its estimated error.
std::vector<UnclearGap> unclear_gaps(const SolvedState& state, const std::vector<PairFigures>& pairs);

}  // namespace cgcontact
