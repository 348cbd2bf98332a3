/// Surfaces that bound a body: planes, spheres, cylinders, cones, or patches of any other shape.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

struct Surface;

/// Surface that no formula of Surface describes.
class SurfacePatch {
 public:
  virtual ~SurfacePatch() = default;
  /// Returns the plane that touches it where it is nearest to x: a point of it and its unit outward normal.
  virtual Surface near(const Vec3& x) const = 0;
  /// Returns the unit outward normal where it is nearest to x, as smooth as the surface that it stands for.
  virtual Vec3 normal(const Vec3& x) const = 0;
};

/// One elementary surface; signed_distance < 0 on its inner side. A cone has two halves that meet in its tip: bodies
/// have it together with the half-space of one of them.
struct Surface {
  enum class Kind { plane, sphere, cylinder, cone, patch };
  Kind kind = Kind::plane;
  Vec3 point = Vec3::Zero();       ///< point of the plane, centre of the sphere, point on the axis, tip of the cone
  Vec3 direction = Vec3::UnitZ();  ///< unit outward normal of the plane, unit axis; of a cone into the used half
  double radius = 0;               ///< sphere, cylinder; of a cone the larger one of the used range
  std::vector<std::string> names;  ///< "primitive.face" names that lie on this surface, e.g. "block.z+"
  std::shared_ptr<const SurfacePatch> patch;
  double cosine = 1, sine = 0;  ///< of the angle between a cone and its axis

  /// Returns the signed distance; of a patch that to the plane that touches it nearest to x.
  double signed_distance(const Vec3& x) const;
  /// Returns the unit gradient of the signed distance; of a patch its normal.
  Vec3 gradient(const Vec3& x) const;
  /// Returns the surface itself; of a patch the plane that touches it nearest to x, without names.
  Surface near(const Vec3& x) const;
  /// Parameters t of the intersections of the line x + t d with the surface, ascending; returns 0, 1 or 2 (0 for a
  /// patch: see BodyGeometry::crossings).
  int intersect_line(const Vec3& x, const Vec3& d, double t[2]) const;
  /// Returns an upper bound of the principal curvatures; of a patch 0, of a cone where it is wide.
  double max_curvature() const { return radius > 0 ? 1.0 / radius : 0.0; }
  /// Returns the same within `reach` of x, of a cone too.
  double max_curvature(const Vec3& x, double reach) const;
};

/// Returns the vector from the axis of a cylinder or a cone to x, across.
Vec3 radial(const Surface& surface, const Vec3& x);
/// Returns the height of x above the tip of a cone, along its axis.
double height(const Surface& cone, const Vec3& x);

}  // namespace cgcontact
