/// Choices that a body's mirror image shall make as well (where to begin, which way to go) are made as seen from here.
#pragma once

#include <cmath>

#include "core/geometry/csg.hpp"

namespace cgcontact {

/// Middle of the solid's bounding box; 0 along axes where it is unbounded.
inline Vec3 middle_of(const Solid& solid) {
  Vec3 min, max;
  solid.bounding_box(min, max);
  const Vec3 sum = min + max;
  return 0.5 * sum.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
}

}  // namespace cgcontact
