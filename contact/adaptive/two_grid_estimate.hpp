/// The estimated error of the contact pressure, from the solutions on two grids.
#pragma once

#include "contact/adaptive/zone_sizes.hpp"

namespace cgcontact {

/// A solution that is kept while the next one is made.
struct EarlierSolution {
  const SolvedState* state = nullptr;  ///< none: there is none whose zones are resolved
  std::vector<double> cell;            ///< m, in each pair's zone
};

/// Sets PairFigures::pressure_error_estimate of every pair that matters, and ContactRow::pressure_error in proportion,
/// to the larger one of
/// - the estimate of the present solution (pressure_estimate.hpp), times AccuracyOptions::safety and, as it fails where
/// a zone is few cells wide, 1 + (doubtful_width / cells across)^2; without an earlier solution times 1.8 as well;
/// - with an earlier solution on cells 1/r times as large, whose errors are independent and fall like the size: change
/// * r / sqrt(1 + r^2), the change being the relative L2 norm of the difference of the two SPR-C pressures at the
/// present contact rows. The errors of the largest pressures follow from the new ones of the rows (peak_estimate.hpp).
/// ZoneState::error is that without the factor of 1.8. Returns the largest change; none without an earlier solution.
std::optional<double> estimate_from_two_grids(std::vector<ZoneState>& zones, const EarlierSolution& earlier,
                                              const AccuracyOptions& options, Results& results);

}  // namespace cgcontact
