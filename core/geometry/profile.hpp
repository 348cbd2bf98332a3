/// Plane profiles of lines and arcs, of which extruded and revolved bodies are made.
#pragma once

#include <optional>
#include <string>

#include "core/geometry/parametric_surface.hpp"

namespace cgcontact {

/// One side of a profile, which ends where the next one begins.
struct ProfileEdge {
  Vec2 from, to;
  std::string face;  ///< "primitive.face"
  bool is_arc = false;
  Vec2 through = Vec2::Zero();  ///< of an arc: a point between its ends
};

struct Circle {
  Vec2 centre;
  double radius;
};

/// Arc of a circle, from a point on.
struct Arc {
  Circle circle;
  double turn;  ///< angle that it covers, counterclockwise positive
};

/// Gives the arc through three points, in their order; none if the parallelogram that they make has an area up to
/// `flat`, m^2.
std::optional<Arc> arc_through(const Vec2& from, const Vec2& through, const Vec2& to, double flat = 0);

/// Gives the area of the parallelogram between two vectors, positive if b is counterclockwise of a.
inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Plane of a profile: its first axis (of a revolved one: from the axis of revolution on) and its second one.
struct ProfileFrame {
  Vec3 origin, first, second;  ///< unit vectors at right angles
};

}  // namespace cgcontact
