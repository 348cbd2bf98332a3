/// Regions bounded by straight lines: cut into convex polygons, exact to rounding.
#pragma once

#include "core/quadrature/region.hpp"

namespace cgcontact {

/// Integrates over a region all of whose functions are linear conics.
void integrate_polygons(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points);

}  // namespace cgcontact
