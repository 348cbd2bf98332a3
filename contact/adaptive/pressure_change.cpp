#include "contact/adaptive/pressure_change.hpp"

#include <cmath>

#include "contact/study/face_pressure.hpp"

namespace cgcontact {
namespace {

/// Zones' cells: rows of larger ones are outside of the zone, where there is no pressure.
constexpr double much_larger = 2.5;

}  // namespace

KeptPressure keep_pressure(const Results& results, const std::vector<ZoneState>& zones) {
  KeptPressure kept;
  kept.rows.resize(zones.size());
  for (const ZoneState& zone : zones) kept.cell.push_back(zone.cell);
  for (const ContactRow& row : results.contact_rows)
    if (row.larger_cell < much_larger * zones[row.pair].cell) kept.rows[row.pair].push_back(row);
  return kept;
}

double pressure_change(const Results& results, int pair, const KeptPressure& earlier) {
  const FacePressure before(earlier.rows[pair], earlier.cell[pair]);
  double difference = 0, norm = 0;
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != pair || row.larger_cell > earlier.cell[pair]) continue;
    const double change = row.pressure_sprc - before(row.body, row.x);
    difference += row.weight * change * change;
    norm += row.weight * row.pressure_sprc * row.pressure_sprc;
  }
  return norm > 0 ? std::sqrt(difference / norm) : 0;
}

}  // namespace cgcontact
