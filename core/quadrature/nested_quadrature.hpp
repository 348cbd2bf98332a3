/// Regions bounded by curves: for every node of an outer Gauss rule in t the segments of s that belong to the region
/// get an inner Gauss rule. The outer interval is broken where the combinatorial structure of the segments changes,
/// and square-root behaviour at tangencies is removed by substitution.
#pragma once

#include "core/quadrature/region.hpp"

namespace cgcontact {

void integrate_nested(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points);

}  // namespace cgcontact
