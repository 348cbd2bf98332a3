/// The edges of the contact zones as the patches ask for them.
#pragma once

#include "core/base/types.hpp"

namespace cgcontact {

/// The edge of a contact zone near some place, found by recovery/zone_edge/edge_search.hpp; global axes.
struct EdgePiece {
  Vec3 origin = Vec3::Zero(), closed = Vec3::UnitX(),
       along = Vec3::UnitY();  ///< m; across the edge into the zone, along it
  double curvature = 0;        ///< 1/m, negative around a convex zone
  double inverse_width = 0;    ///< of the zone across the edge, 1/m; 0: not known
  double factor = 0;           ///< of the term, Scales::stress per square root of a metre
  double place_error = 0;      ///< expected, across the edge, m
  /// Distance from the edge of the zone, or from the opposite one if that is nearer; negative outside; m.
  double inside(const Vec3& x) const {
    const double t = along.dot(x - origin), s = closed.dot(x - origin) + 0.5 * curvature * t * t;
    return 2 * s * inverse_width > 1 ? 1 / inverse_width - s : s;
  }
};

/// Where the edges of all pairs run.
class EdgeMap {
 public:
  virtual ~EdgeMap() = default;
  /// The edge of a pair near x (m, global axes); false if there is none in reach.
  virtual bool near(int pair, const Vec3& x, EdgePiece& piece) const = 0;
  /// Whether any edges of a pair were found.
  virtual bool has(int pair) const = 0;
};

}  // namespace cgcontact
