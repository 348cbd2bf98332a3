#include "core/drawing/curve_ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {

namespace {

/// Sine of the angle between a curve and a plane that it runs along: rounding is far below.
constexpr double along_plane = 1e-6;
/// Sine of the angle between a curve and a plane across it, 82 degrees: the last chord of a path that goes all round
/// and meets the plane at a right angle is off by half a degree.
constexpr double across_plane = 0.99;

}  // namespace

std::optional<CurveEnd> end_at_plane(const CurveTip& tip, const std::vector<SymmetryPlane>& planes) {
  const double length = tip.outward.norm();
  for (const SymmetryPlane& plane : planes) {
    const double towards = plane.normal.dot(tip.outward), left = -plane.distance(tip.x);
    if (!(towards > along_plane * length) || !(left < towards)) continue;
    return CurveEnd{plane, tip.s + tip.outward_s * left / towards, towards > across_plane * length};
  }
  return std::nullopt;
}

std::vector<CurvePoint> mirror_image(std::vector<CurvePoint> curve, const CurveEnd& end) {
  if (curve.empty()) return curve;
  const auto distance = [&](const CurvePoint& point) { return std::abs(point[0] - end.s); };
  if (distance(curve.back()) < distance(curve.front())) std::reverse(curve.begin(), curve.end());
  const CurvePoint own_end = curve.front();
  for (CurvePoint& point : curve) point[0] = end.mirrored(point[0]);
  curve.insert(curve.begin(), own_end);
  return curve;
}

std::string name_of(const SymmetryPlane& plane, double largest) {
  int axis = 0;
  if (plane.normal.cwiseAbs().maxCoeff(&axis) < 1 - rounding) return "a plane of symmetry";
  const double at = plane.point[axis];
  if (std::abs(at) <= rounding * largest) return fmt::format("{} = 0", "xyz"[axis]);
  const DisplayUnit unit = length_unit(std::abs(at));
  return fmt::format("{} = {} {}", "xyz"[axis], short_number(at * unit.factor), unit.name);
}

}  // namespace cgcontact
