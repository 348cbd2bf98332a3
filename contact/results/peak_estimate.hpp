/// Estimated error of the largest contact pressure. Evidence: docs/recovery.md, "Error figures".
#pragma once

#include "core/results/results.hpp"

namespace cgcontact {

/// Sets PairFigures::max_pressure_error_estimate of all pairs from the estimated errors of their contact rows. Around
/// the largest pressure, where it is at least 0.9 of that on either face and at most four cells away, a quadratic
/// function is fitted: the estimate is the excess of the largest value over the fit (the largest of scattered values is
/// too large), plus the root mean square of ContactRow::pressure_error there, over the largest pressure. None where
/// nothing touches, the zone is not resolved, or a SingularPlace is within four cells: then there is no largest
/// pressure.
void estimate_peak_errors(Results& results);

}  // namespace cgcontact
