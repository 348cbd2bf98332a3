/// Pressures known from the problems on the contact faces (recovery/face/face_zone.hpp), for the patches.
#pragma once

#include <optional>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Segment of the edge of a contact zone; global axes.
struct ZoneEdgeSegment {
  Vec3 origin = Vec3::Zero(), closed = Vec3::UnitX(),
       along = Vec3::UnitY();  ///< m; across the edge into the zone, along it
  double curvature = 0;        ///< 1/m, negative around a convex zone
  double inverse_width = 0;    ///< of the zone across the edge, 1/m; 0: not known
  double factor = 0;           ///< pressure at a distance s inside: factor sqrt(s), Pa per square root of a metre
  /// Returns the distance from the edge of the zone, negative outside, m.
  double inside(const Vec3& x) const {
    const double t = along.dot(x - origin);
    return closed.dot(x - origin) + 0.5 * curvature * t * t;
  }
};

class KnownPressures {
 public:
  virtual ~KnownPressures() = default;
  /// Returns the square of the contact pressure at x (m) on the face of a body with outward normal n, global axes,
  /// Pa^2; negative outside of the zone. None: no problem reaches there.
  virtual std::optional<double> square(int pair, int body, const Vec3& x, const Vec3& n) const = 0;
  /// Returns whether there is such a problem for any zone of the pair.
  virtual bool has_zone(int pair) const = 0;
  /// Finds the edge of a zone of the pair near x (m, global axes); false if none in reach.
  virtual bool edge_near(int pair, const Vec3& x, ZoneEdgeSegment& segment) const = 0;
};

}  // namespace cgcontact
