/// Pairs of triangles of a surface that cross each other.
#pragma once

#include <utility>
#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Finds pairs (lower number first, ascending) in which an edge of one triangle passes through the other one. Triangles
/// that only touch, up to rounding, do not cross.
std::vector<std::pair<int, int>> find_crossings(const std::vector<Vec3>& points,
                                                const std::vector<Triangle>& triangles);

}  // namespace cgcontact
