/// Curves on contact faces that end at planes of symmetry, behind which they go on as their mirror images.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/symmetry_plane.hpp"

namespace cgcontact {

/// First or last point of a curve.
struct CurveTip {
  double s = 0;                 ///< coordinate along the curve, m
  Vec3 x = Vec3::Zero();        ///< m
  Vec3 outward = Vec3::Zero();  ///< m, step of the curve that leads to the tip
  double outward_s = 0;         ///< change of the coordinate in that step, m
};

/// Position at which a plane of symmetry ends a curve.
struct CurveEnd {
  SymmetryPlane plane;
  double s = 0;         ///< m, of the plane
  bool across = false;  ///< the plane is perpendicular to the curve, which goes on straight as its mirror image

  double mirrored(double coordinate) const { return 2 * s - coordinate; }
};

/// Coordinate (m) and value along a curve.
using CurvePoint = std::array<double, 2>;

/// Returns the mirror image of a curve, from its own end at the plane on; none of an empty one.
std::vector<CurvePoint> mirror_image(std::vector<CurvePoint> curve, const CurveEnd& end);

/// Returns the plane behind which one more step from the tip would lie; none: the curve ends elsewhere, or runs along
/// the plane.
std::optional<CurveEnd> end_at_plane(const CurveTip& tip, const std::vector<SymmetryPlane>& planes);

/// Returns "x = 0", "y = 2.5 mm"; of a plane across no coordinate axis "a plane of symmetry". largest: m, the largest
/// length of the picture, beside which rounding is zero.
std::string name_of(const SymmetryPlane& plane, double largest);

}  // namespace cgcontact
