/// Which zones are so narrow and so round that their edges come from recovery/zone_edge/narrow_zone.hpp, and these
/// edges.
#pragma once

#include "recovery/zone_edge/contact_zone.hpp"
#include "recovery/zone_edge/found_edges.hpp"

namespace cgcontact {

/// Edges in narrow round zones, one for each closed cell (in the order of zone.closed_cells()) there. Samples in these
/// zones are taken out of `samples`, whose widths are known; zones of another profile than Hertz's get none.
std::vector<EdgeSample> take_narrow_edges(const ContactZone& zone, const std::vector<TransmittedForce>& closed,
                                          double stress_unit, const EdgeOptions& options,
                                          std::vector<EdgeSample>& samples);

}  // namespace cgcontact
