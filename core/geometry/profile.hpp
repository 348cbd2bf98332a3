/// Plane profiles of lines and arcs, of which extruded and revolved bodies are made.
#pragma once

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

/// Plane of a profile: its first axis (of a revolved one: from the axis of revolution on) and its second one.
struct ProfileFrame {
  Vec3 origin, first, second;  ///< unit vectors at right angles
};

}  // namespace cgcontact
