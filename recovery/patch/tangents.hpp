/// Tangent frame of a surface.
#pragma once

#include <utility>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Returns two unit vectors that complete the unit vector n to a right-handed orthonormal frame (n, t1, t2).
std::pair<Vec3, Vec3> tangents(const Vec3& n);

}  // namespace cgcontact
