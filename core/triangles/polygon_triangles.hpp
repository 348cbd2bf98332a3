/// Polygons in space as triangles.
#pragma once

#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Returns triangles (indices into the list of corners) of a simple polygon that is nearly flat: a fan around its first
/// corner if it is convex, else by ear clipping in the plane of its mean normal (Meisters, Polygons have ears, Amer.
/// Math. Monthly 82, 1975). Empty if the polygon has no area or crosses itself.
std::vector<Triangle> polygon_triangles(const std::vector<Vec3>& corners);

}  // namespace cgcontact
