/// Positions of contact zones that are smaller than their cells.
#pragma once

#include "contact/adaptive/zone_sizes.hpp"

namespace cgcontact {

/// Narrows a zone that is not resolved to where the undeformed bodies overlap, sampled between the quadrature points,
/// when they are pressed together by the force that its groups transmit: F = 1.07 E* V / sqrt(A), as in small_zones.hpp
/// (planes of symmetry of both bodies complete it); on quadtrees, in line contact, F = 3 pi / 4 E* V / width. Sets
/// positions and width. Does nothing where the overlap fills the groups: then their cells are about as large as the
/// zone.
void narrow_to_overlap(const SolvedState& state, std::size_t pair, ZoneState& zone);

}  // namespace cgcontact
