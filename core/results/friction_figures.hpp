/// Coulomb friction of a contact pair: what it carries, and what it can carry before the faces slide all over. SI
/// units, global axes.
#pragma once

#include <optional>
#include <string>

#include "core/scene/face_traction.hpp"

namespace cgcontact {

/// Sentence that stands once wherever these figures are shown.
constexpr const char* friction_note =
    "capacity is mu times the integral of the pressure, use the part of it that friction carries, as a force or "
    "a torque; what sticks and slips depends on the order of the loads ([steps])";

/// Capacity about an axis.
struct TorqueCapacity {
  enum class From { scene, faces_of_revolution, flat_faces, mean_normal };
  Axis axis;
  From from = From::scene;      ///< where the axis comes from
  double capacity = 0;          ///< N m, the coefficient times the integral of pressure times distance from the axis
  double whole = 0;             ///< N m, of all equal sectors of the zone (ZoneFigures::sectors)
  double carried = 0;           ///< N m, what friction acts with on the first body about the axis
  std::optional<double> error;  ///< estimated, relative; none: that of the force has none
};

inline const char* name_of(TorqueCapacity::From from) {
  constexpr const char* names[] = {"moment_about", "axis of the faces", "normal of the faces", "mean normal"};
  return names[static_cast<int>(from)];
}

struct FrictionFigures {
  double coefficient = 0;
  double capacity = 0;                   ///< N, the coefficient times the integral of the transmitted pressure
  double whole = 0;                      ///< N, of all equal sectors of the zone
  std::optional<double> error;           ///< estimated, relative; none: not resolved, or of a step before the last
  std::optional<TorqueCapacity> torque;  ///< none: no axis is known
  std::string why_no_torque;
  /// Use of friction by force and moment on the whole zone (use_of_friction()); 1: the faces slide. None: nothing
  /// presses.
  std::optional<double> use;
  Vec3 force = Vec3::Zero();             ///< N, what friction acts with on the first body
  double stick_area = 0, slip_area = 0;  ///< m^2, of the closed points
  double max_slip = 0;                   ///< m, since the points met
  /// Estimated error of the recovered shear, relative L2 over both faces: its distance from the transmitted one. None:
  /// the shear is less than a hundredth of the coefficient times the pressure.
  std::optional<double> shear_error;
  double work = 0;  ///< J, dissipated in all steps
  double wear = 0;  ///< J, integral of ContactRow::wear: times Archard's coefficient over the hardness, m^3 worn off
};

/// "sticks everywhere", "partial slip: ..." or "slips everywhere"; "" without contact.
std::string verdict_on(const FrictionFigures& friction);
/// "62 %".
std::string use_text(double use);
/// "0, 0, 1"
std::string components_text(const Vec3& direction);

}  // namespace cgcontact
