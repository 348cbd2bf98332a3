/// View from a boundary point of one body to another body along its normal.
#pragma once

#include <optional>

#include "contact/model/model.hpp"

namespace cgcontact {

/// Distances that a point sees along its outward normal, m.
struct Reach {
  double ahead = 0;   ///< gaps
  double behind = 0;  ///< overlaps
};

/// Cells, from a surface into the body: less than the thinnest cells that are kept, more than rounding of positions.
constexpr double inward_step = 1e-12;

/// Least cosine between a direction and the faces that it is seen from or met on: steeper ones are no opposites.
constexpr double min_facing_cosine = 0.1;

/// Point of another body's boundary met along a normal.
struct OppositePoint {
  double distance;  ///< m, along the ray (negative: the bodies overlap there)
  int cell;         ///< active cell of the other body
  Vec3 position;    ///< grid coordinates of the other body
  Vec3 normal;      ///< outward of the other body, global axes
};

/// Finds the boundary point of `other` (face `face`) on the line x + t n that a boundary point x of `own` with outward
/// normal n touches or would touch: its normal opposes n, and between them lies neither body (a gap, t > 0) or both (an
/// overlap, t < 0). So neither the far side of a thin body is met, nor what lies behind one.
std::optional<OppositePoint> find_opposite(const BodyModel& own, const BodyModel& other, const FaceSpec& face,
                                           const Vec3& x, const Vec3& n, const Reach& reach);

/// Returns whether the body comes between a point and another one `distance` (m) ahead of it.
bool comes_between(const BodyModel& body, const Vec3& x, const Vec3& n, double distance);

/// Returns the longest edge of the box around a body in global axes, m.
double longest_extent(const BodyModel& body);
/// Returns the least distance between the boxes around two bodies in global axes, m; 0 if they overlap.
double box_distance(const BodyModel& a, const BodyModel& b);

}  // namespace cgcontact
