/// Force, moments, extents of the contact zone of every pair, and Hertz's answer beside them.
#pragma once

#include <optional>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {

/// Sets PairFigures::zone of all pairs, whose other figures are those of the whole thickness of the bodies.
void set_zone_figures(const SolvedState& state, const std::vector<ContactRow>& rows, std::vector<PairFigures>& pairs);

/// Symmetry planes and mean normal of the zone of a pair.
struct ZoneFrame {
  std::vector<SymmetryPlane> planes;  ///< behind which it goes on; none where they are neither parallel nor across
  std::optional<Vec3> normal;         ///< mean, outward of the primary body, where the zone is nearly flat
};
/// Finds both. Needs PairFigures::max_pressure.
ZoneFrame frame_of_zone(const SolvedState& state, const std::vector<ContactRow>& rows,
                        const std::vector<PairFigures>& pairs, int pair);

}  // namespace cgcontact
