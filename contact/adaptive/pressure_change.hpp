/// How far the contact pressures of two grids are apart.
#pragma once

#include "contact/adaptive/zone_sizes.hpp"

namespace cgcontact {

/// Contact pressure of a solve, kept while the next one is made: rows where cells are not much larger than in the
/// zones.
struct KeptPressure {
  std::vector<std::vector<ContactRow>> rows;  ///< of each pair
  std::vector<double> cell;                   ///< m, in each pair's zone
};
KeptPressure keep_pressure(const Results& results, const std::vector<ZoneState>& zones);

/// Relative L2 norm of the difference between the present SPR-C pressure of a pair and an earlier one, interpolated
/// along the faces (FacePressure), over the present rows.
double pressure_change(const Results& results, int pair, const KeptPressure& earlier);

}  // namespace cgcontact
