/// Planes where the values of a scene's expressions jump, as in "x < 5 mm ? a : b".
#pragma once

#include <vector>

#include "core/expressions/expression.hpp"

namespace cgcontact {

/// normal . x = offset, m, global axes; unit normal.
struct JumpPlane {
  Vec3 normal;
  double offset;
};

/// Finds the planes in the box [min, max] (m) at which a comparison in the expression changes, as far as what is
/// compared is linear in x, y, z in regions of the box (max(abs(x), abs(y)) < 2 mm: four planes). By its values around
/// points spread over the box; comparisons that curve ("x^2 + y^2 < r^2") give none.
std::vector<JumpPlane> jump_planes(const Expression& expression, const Vec3& min, const Vec3& max);

}  // namespace cgcontact
