/// Where the edges of the contact zones run: from the border between closed and open contact points to the place that
/// the transmitted forces give (recovery/zone_edge/edge_fit.hpp), with a parabola through the places found around; in
/// zones of few cells (recovery/zone_edge/narrow_edges.hpp) the edge that the zone's moments give. Evidence:
/// docs/recovery.md.
#pragma once

#include "recovery/spr/recovery_input.hpp"
#include "recovery/zone_edge/found_edges.hpp"

namespace cgcontact {

/// Edges of all pairs, from the contact links of the bodies.
FoundEdges find_contact_edges(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                              const RecoveryOptions& options);

}  // namespace cgcontact
