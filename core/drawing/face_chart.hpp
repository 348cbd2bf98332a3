/// Lays a face of a body out on paper.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Triangles of a face with outward orientation; positions in m.
struct FaceTriangles {
  const std::vector<Vec3>* position = nullptr;
  std::vector<std::array<int, 3>> triangles;
};

/// Maps points of a face to (right, up, towards the viewer), m.
class FaceChart {
 public:
  /// Charts a face. One whose normals lie in one plane and spread by more than about 30 degrees is a cylinder, if it is
  /// round: it is unrolled, `right` being the arc length. Others are projected: along the coordinate axis within 18
  /// degrees of the mean normal; a curved one along the last of the coordinate axes that its normals do not turn away
  /// from and that is about as near to the mean normal as any, so that a cup keeps its symmetry; else along the mean
  /// normal.
  explicit FaceChart(const FaceTriangles& face);

  /// Returns the chart position of x in a triangle near `near`, so that no triangle of a closed cylinder is torn.
  Vec3 position(const Vec3& x, const Vec3& near) const;
  Vec3 position(const Vec3& x) const { return position(x, x); }
  /// Returns whether the picture is seen from inside the body: triangles are to be turned round.
  bool mirrored() const { return mirrored_; }
  /// Returns the direction of an axis of the chart (0: right, 1: up) at x, global axes.
  Vec3 direction(int axis, const Vec3& x) const;
  /// Returns the axis of the chart (0: right, 1: up) that a direction is more nearly across to.
  int axis_across(const Vec3& direction) const;
  bool unrolled() const { return radius_ > 0; }
  const std::string& right_name() const { return right_name_; }
  const std::string& up_name() const { return up_name_; }

 private:
  bool unroll(const FaceTriangles& face, const Mat3& normals);
  int axis_of_curved_face(const FaceTriangles& face, const Vec3& mean_normal, const Mat3& normals) const;
  void project(const Vec3& mean_normal, int axis);
  double angle(const Vec3& x) const;

  Vec3 right_ = Vec3::UnitX(), up_ = Vec3::UnitY(), eye_ = Vec3::UnitZ();
  Vec3 centre_ = Vec3::Zero();  ///< of the cylinder
  double radius_ = 0, middle_angle_ = 0;
  bool mirrored_ = false;
  std::string right_name_, up_name_;
};

}  // namespace cgcontact
