/// A plane of symmetry: what lies on one side goes on behind it as its mirror image.
#pragma once

#include "core/base/numbers/types.hpp"

namespace cgcontact {

struct SymmetryPlane {
  Vec3 point, normal;  ///< m; outward unit normal, global axes
  /// Returns the distance of a point from the plane, m: negative inside.
  double distance(const Vec3& x) const { return normal.dot(x - point); }
  Vec3 image(const Vec3& x) const { return x - 2 * distance(x) * normal; }
  Vec3 turned(const Vec3& v) const { return v - 2 * normal.dot(v) * normal; }
};

}  // namespace cgcontact
