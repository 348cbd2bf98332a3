/// Estimated error of the largest contact pressure. Evidence: docs/recovery.md, "Error figures".
#pragma once

#include "core/results/results.hpp"

namespace cgcontact {

/// Sets PairFigures::max_pressure_error_estimate of all pairs from the estimated errors of their contact rows: the
/// largest ContactRow::pressure_error where the pressure is at least 0.9 of the largest, on either face, as any of
/// these may be it; plus the excess of the largest value over a quadratic function fitted to those at most four cells
/// away (the largest of scattered values is too large); over the largest pressure. None where nothing touches, the zone
/// is not resolved, or a SingularPoint is within four cells: then there is no largest pressure.
void estimate_peak_errors(Results& results);

}  // namespace cgcontact
