/// Sums of forces around an axis of revolution.
#pragma once

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Projects the sum of a vector of the half-plane (a force, a first moment) around the axis, and that of the moments:
/// for a body of revolution the component along the axis, and no moment. Others stay as they are.
inline void sum_around_axis(const BodySpec& body, Vec3& sum, Vec3* moment = nullptr) {
  if (!body.axisymmetric()) return;
  const int axis = body.axis_of_revolution();
  sum = sum[axis] * Vec3::Unit(axis);
  if (moment) moment->setZero();
}

}  // namespace cgcontact
