/// Values of t at which the structure of a region's slices changes.
#pragma once

#include <vector>

#include "core/quadrature/outer_map.hpp"
#include "core/quadrature/region_slice.hpp"

namespace cgcontact {

/// Finds the non-empty intervals in ascending order.
void find_intervals(Slicer& slicer, std::vector<Interval>& intervals);

}  // namespace cgcontact
