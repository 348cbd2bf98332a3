/// Capacity of friction of a contact pair before it slides all over, with the pressure of the frictionless
/// solution. SI units, global axes.
#pragma once

#include <optional>
#include <string>

#include "core/scene/face_traction.hpp"

namespace cgcontact {

/// Sentence that stands once wherever these figures are shown.
constexpr const char* friction_note =
    "the solve is frictionless; capacity, mu times the integral of its pressure, bounds friction before all of a face "
    "slips";

/// Capacity about an axis.
struct TorqueCapacity {
  enum class From { scene, faces_of_revolution, flat_faces, mean_normal };
  Axis axis;
  From from = From::scene;      ///< where the axis comes from
  double capacity = 0;          ///< N m, the coefficient times the integral of pressure times distance from the axis
  double whole = 0;             ///< N m, of all equal parts of the zone (ZoneFigures::parts)
  std::optional<double> error;  ///< estimated, relative; none: that of the force has none
};

inline const char* name_of(TorqueCapacity::From from) {
  constexpr const char* names[] = {"moment_about", "axis of the faces", "normal of the faces", "mean normal"};
  return names[static_cast<int>(from)];
}

struct FrictionFigures {
  double coefficient = 0;
  double capacity = 0;                   ///< N, the coefficient times the integral of the transmitted pressure
  double whole = 0;                      ///< N, of all equal parts of the zone
  std::optional<double> error;           ///< estimated, relative; none: not resolved, or of a step before the last
  std::optional<TorqueCapacity> torque;  ///< none: no axis is known
  std::string why_no_torque;
  /// Part that loads ask of friction along the motion that they drive and that friction alone resists, over the most
  /// that it can carry there; infinite: nothing presses. None: no load drives such a motion of this pair.
  std::optional<double> use;
};

/// "slides: ..." or "friction could carry it: ..."; "" without a use.
std::string verdict_on(const FrictionFigures& friction);
/// "62 %", "more than any".
std::string use_text(double use);
/// "0, 0, 1"
std::string components_text(const Vec3& direction);

}  // namespace cgcontact
