/// Integration over regions: the one building block of all cell integrals.
#pragma once

#include "core/quadrature/region.hpp"

namespace cgcontact {

/// Appends the points of the rule to `points`.
void integrate_region(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points);

}  // namespace cgcontact
