/// Two coordinates along a contact face: projection of a nearly flat one to a plane, angle of a round one about its
/// axis.
#pragma once

#include <optional>
#include <vector>

#include "recovery/face/face_grid.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {

/// Point of the zone, m; outward unit normal; area, m^2.
struct FacePoint {
  Vec3 x, normal;
  double weight;
};

class ZoneChart {
 public:
  /// Makes the chart of a zone's points. planes: symmetry planes at the zone. across: the axis (global) of plane
  /// strain, or -1: it is axis 0 then. turned: axes of the body's grid, with which those of a flat face turn. None: the
  /// face turns too much and about no single axis, or the planes do not go with its axes.
  static std::optional<ZoneChart> make(const std::vector<FacePoint>& points, const std::vector<SymmetryPlane>& planes,
                                       int across, const Mat3& turned);

  FacePosition coordinates(const Vec3& x) const;
  /// Returns the point at a chart position, near the face.
  Vec3 point(const FacePosition& position) const;
  /// Returns the unit normal of the chart at a point.
  Vec3 normal(const Vec3& x) const;
  /// Returns the height of a point above the plane, or above the mean radius, m.
  double height(const Vec3& x) const;
  const std::array<FaceEnd, 2>& ends() const { return ends_; }
  /// Returns the distance between the two symmetry planes of an axis that has two, m.
  double length(int axis) const { return length_[axis]; }

 private:
  bool set_ends(const std::vector<SymmetryPlane>& planes);
  /// Returns the vector from the axis of a round face to a point.
  Vec3 radial(const Vec3& x) const;

  bool round_ = false;
  Vec3 origin_ = Vec3::Zero();                     ///< has the coordinates 0; round: on the axis
  Vec3 axis_[2] = {Vec3::UnitX(), Vec3::UnitY()};  ///< round: the axis of the face, and its radial direction at angle 0
  Vec3 normal_ = Vec3::UnitZ();                    ///< round: axis_[0] x axis_[1]
  double radius_ = 0, outward_ = 1;                ///< outward: +1, the normal points away from the axis
  std::array<FaceEnd, 2> ends_{FaceEnd::free, FaceEnd::free};
  std::array<double, 2> length_{0, 0};
};

}  // namespace cgcontact
