/// Traction on a face with a given force and moment: constant, and growing in proportion to the distance from the
/// centroid; or the pressure of a bearing.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Line: the axis of a cylinder.
struct Axis {
  Vec3 point = Vec3::Zero();       ///< m
  Vec3 direction = Vec3::UnitZ();  ///< unit
};

/// t(x) = constant + spin x (x - centre), and where the outward normal n points against `bearing` a pressure
/// -bearing . n.
struct FaceTraction {
  Vec3 constant = Vec3::Zero();  ///< Pa
  Vec3 spin = Vec3::Zero();      ///< Pa/m
  Vec3 centre = Vec3::Zero();    ///< m
  Vec3 bearing = Vec3::Zero();   ///< Pa
  Vec3 at(const Vec3& x, const Vec3& n) const {
    return constant + spin.cross(x - centre) + std::min(0.0, bearing.dot(n)) * n;
  }
};

/// Moments of a face by the quadrature points that loads are integrated with: so the body gets exactly the prescribed
/// force and moment.
class FaceMoments {
 public:
  /// across: coordinate axis across which the body is in plane strain: moments act about it alone; none: in space.
  explicit FaceMoments(std::optional<int> across = {}) : across_plane_(across) {}
  /// Adds a point: m, unit outward normal, m^2.
  void add(const Vec3& x, const Vec3& n, double area);
  double area() const { return area_; }
  Vec3 centroid() const { return origin_ + first_ / area_; }
  /// Returns the traction statically equivalent to a force (N) at a point (m) and a moment (N m): about the centroid c
  /// the moment is M + (at - c) x F = integral of r x (spin x r) = (tr(S) I - S) spin, S the second moments of area
  /// about c. In plane strain it does not matter where along the axis a force acts. Throws InputError (without a line)
  /// for a moment that the face cannot carry: of a line, or in plane strain about another axis.
  FaceTraction with_resultants(const Vec3& force, const Vec3& moment, const Vec3& at) const;
  /// Returns the cosine pressure on the half of a cylinder that faces a force (N): its resultant is the force, or, of a
  /// sector of that half (cut at a plane of symmetry), has the force's component along it. Throws InputError (without a
  /// line) if the face is no cylinder, or the force acts along its axis.
  FaceTraction with_bearing(const Vec3& force) const;
  /// Returns the axis of a cylinder, or of facets that stand for one; none for other faces.
  std::optional<Axis> axis() const;

 private:
  /// Integrates n (n . slope) over the face's points with n . slope < 0: the vector, N, and its derivative by the
  /// slope.
  std::pair<Vec3, Mat3> pressed(const Vec3& slope) const;

  std::optional<int> across_plane_;
  double area_ = 0;
  Vec3 origin_ = Vec3::Zero();  ///< the first point: lengths are from there
  Vec3 first_ = Vec3::Zero();
  Mat3 second_ = Mat3::Zero();
  Mat3 normals_ = Mat3::Zero();                  ///< sum of area n n^T
  Vec3 across_ = Vec3::Zero();                   ///< of area (I - n n^T) x
  double square_ = 0;                            ///< of area |(I - n n^T) x|^2
  std::vector<std::pair<Vec3, double>> points_;  ///< normal and area of each
};

}  // namespace cgcontact
