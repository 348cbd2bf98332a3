/// Number of cells across the contact zones of each pair: whether the contact is resolved.
#pragma once

#include <optional>
#include <vector>

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

struct ZoneWidth {
  /// Cells (the larger ones of both bodies there) across the narrowest zone that carries a relevant fraction of the
  /// pair's force, in the mean along that zone. None: no contact, or no open points beside it (the zone ends where a
  /// face ends).
  std::optional<double> cells;
  double cell = 0;  ///< m, the size of these
};

/// Returns one per pair. A zone is a connected set of closed cells, completed by planes of symmetry of both bodies. Its
/// width at a point of its ridge is twice the distance from all open points (ends of a face, and faces of a plate one
/// cell thick, do not count), refined by the spread of the transmitted forces along that direction; averaged over the
/// ridge, as whole groups make a long zone too wide in some positions. Zones smaller than the cells have the width that
/// their law gives (small_zones.hpp). Needs the contact links with their pressures (contact/stress_recovery.hpp).
std::vector<ZoneWidth> zone_widths(const SolvedState& state);

}  // namespace cgcontact
