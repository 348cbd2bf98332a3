/// Sums of forces around an axis of revolution.
#pragma once

#include "core/scene/scene.hpp"

namespace cgcontact {

/// The sum around the axis of a vector of the half-plane (a force, the first moment of a place), and of the moments: of
/// a body of revolution what is along the axis, and no moment. Of other bodies they are left.
inline void sum_around_axis(const BodySpec& body, Vec3& sum, Vec3* moment = nullptr) {
  if (!body.axisymmetric()) return;
  const int axis = body.axis_of_revolution();
  sum = sum[axis] * Vec3::Unit(axis);
  if (moment) moment->setZero();
}

}  // namespace cgcontact
