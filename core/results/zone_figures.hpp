/// Figures of the contact zone of a pair: force, moments, extents, and Hertz's answer beside it. SI units, global axes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/base/numbers/types.hpp"
#include "core/geometry/symmetry_plane.hpp"

namespace cgcontact {

/// Moments of the contact forces about a point of the scene.
struct MomentAbout {
  Vec3 point = Vec3::Zero();                                  ///< m
  std::optional<Vec3> axis;                                   ///< of length 1
  Vec3 on_first = Vec3::Zero(), on_second = Vec3::Zero();     ///< N m
  std::optional<double> about_axis_first, about_axis_second;  ///< N m, the components along the axis
};

/// The zone laid out on its mean tangent plane, images behind symmetry planes included.
struct ZoneExtent {
  enum class Shape { round, rectangular, other };
  Shape shape = Shape::other;
  /// m, descending: of the ellipse, or the rectangle, that has the zone's second moments of area.
  std::array<double, 2> half_axes{};
  std::array<Vec3, 2> directions{Vec3::Zero(), Vec3::Zero()};  ///< of length 1
};

inline const char* name_of(ZoneExtent::Shape shape) {
  constexpr const char* names[] = {"round", "rectangular", "other"};
  return names[static_cast<int>(shape)];
}

/// Hertz's theory for the computed force: half axes and largest pressure.
struct HertzFigures {
  std::optional<double> a;  ///< m, the longer half axis; none: line contact
  double b = 0;             ///< m, the shorter half axis, or half the width of the line
  double p0 = 0;            ///< Pa
};

/// All zero or none where nothing is transmitted.
struct ZoneFigures {
  double normal_force = 0;   ///< N, integral of the transmitted pressure: magnitudes, not their resultant
  double mean_pressure = 0;  ///< Pa, that over the area
  int sectors = 1;           ///< equal ones that planes of symmetry divide the whole zone into; one of them is modelled
  /// Planes of symmetry that the zone reaches; for bodies of revolution also one at the axis.
  std::vector<SymmetryPlane> planes;
  std::optional<MomentAbout> moment;
  std::optional<ZoneExtent> extent;   ///< none: the zone goes round a corner or about an axis
  std::optional<HertzFigures> hertz;  ///< none: the faces there are no quadrics, or his theory does not hold
};

}  // namespace cgcontact
