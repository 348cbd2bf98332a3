/// Middle and sides of a body's bounding box. Choices that hold for a body's mirror image too (where to begin, which
/// way to go) are made from the middle.
#pragma once

#include <cmath>

#include "core/geometry/solid.hpp"

namespace cgcontact {

/// Returns the middle of the body's bounding box; 0 along axes where it is unbounded.
inline Vec3 middle_of(const BodyGeometry& body) {
  Vec3 min, max;
  body.bounding_box(min, max);
  const Vec3 sum = min + max;
  return 0.5 * sum.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
}
inline Vec3 middle_of(const Solid& solid) { return middle_of(solid.geometry()); }

/// Sides of the bounding box, and the longest one.
inline Vec3 extent_of(const Solid& solid) {
  Vec3 min, max;
  solid.bounding_box(min, max);
  return max - min;
}
inline double longest_side(const Solid& solid) { return extent_of(solid).maxCoeff(); }

}  // namespace cgcontact
