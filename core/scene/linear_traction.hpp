/// A traction on a face with a given force and moment: constant, and growing in proportion to the distance from the
/// centroid.
#pragma once

#include <string>

#include "core/base/types.hpp"

namespace cgcontact {

/// t(x) = constant + spin x (x - centre), Pa.
struct LinearTraction {
  Vec3 constant = Vec3::Zero();  ///< Pa
  Vec3 spin = Vec3::Zero();      ///< Pa/m
  Vec3 centre = Vec3::Zero();    ///< m
  Vec3 at(const Vec3& x) const { return constant + spin.cross(x - centre); }
};

/// Moments of a face by the quadrature points that loads are integrated with: what acts on the body then has exactly
/// the force and moment asked for, whatever the area of the points.
class FaceMoments {
 public:
  /// m, m^2
  void add(const Vec3& x, double area);
  double area() const { return area_; }
  Vec3 centroid() const { return first_ / area_; }
  /// Statically equivalent to a force (N) at a place (m) and a moment (N m): about the centroid c the moment is
  /// M + (at - c) x F = integral of r x (spin x r) = (tr(S) I - S) spin, S the second moments of area about c. Throws
  /// InputError (without a place) if the face has a moment to carry and is a line.
  LinearTraction with_resultants(const Vec3& force, const Vec3& moment, const Vec3& at) const;

 private:
  double area_ = 0;
  Vec3 first_ = Vec3::Zero();
  Mat3 second_ = Mat3::Zero();
};

}  // namespace cgcontact
