/// Positions of contact zones that are smaller than their cells.
#pragma once

#include "contact/adaptive/zone_sizes.hpp"

namespace cgcontact {

/// Narrows an unresolved zone to the overlap of the undeformed bodies, sampled between the quadrature points, under the
/// force of its groups: F = 1.07 E* V / sqrt(A), as in small_zones.hpp (completed by planes of symmetry of both
/// bodies); on quadtrees, in line contact, F = 3 pi / 4 E* V / width. Sets positions and width. Does nothing where the
/// overlap fills the groups: then their cells are about as large as the zone.
void narrow_to_overlap(const SolvedState& state, std::size_t pair, ZoneState& zone);

}  // namespace cgcontact
