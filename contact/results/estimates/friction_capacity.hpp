/// Friction of every pair with a coefficient (PairFigures::friction): what it carries, and its capacity.
#pragma once

#include <array>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets PairFigures::friction of the pairs with friction, for the thickness of the bodies. Needs the pairs' other
/// figures and the contact rows; errors only with the verdict and the estimates of the forces.
/// - The capacity is the coefficient times the normal force (ZoneFigures::normal_force): the integral of the pressure
///   that the solution transmits. Its error is that of the force, or of the energy norm where the force has none (a
///   shrink fit); where the loads give the force it is what the face turns away from the force of the pressure's error.
/// - The torque capacity is that normal force times the mean distance from the axis, weighted by the recovered pressure
///   (ContactRow::pressure_sprc), which ends where the zone does. Its error has besides what the transmitted pressure
///   gives otherwise. Axis: that of `moment_about`; else the one that all of the zone's faces turn about and stay what
///   they are, if they have one; else, where the zone is nearly flat, its mean normal through the centre of pressure.
/// - Force, torque, use and areas are those of the closed points, with the shear that the solution transmits.
void fill_friction(const SolvedState& state, Results& results);

/// Returns the square of the distance of a row's recovered shear from the transmitted one, Pa^2.
inline double squared_shear_difference(const ContactRow& row) {
  return (row.shear_sprc - row.shear_transmitted).squaredNorm();
}

/// Returns whether shear of mu p changes the pressure of a pair: it moves faces along their normals by Dundurs' second
/// constant times the pressure's effect (Johnson, Contact Mechanics, 2.2 and 5.4), not at all for one material.
bool shear_changes_pressure(const SolvedState& state, const ContactPair& pair);

/// Warns of bodies that slip while they are pressed in few steps; of slip that is no longer small.
std::vector<std::string> friction_warnings(const SolvedState& state);

/// Pressed point: m, outward unit normal, m^2 of area.
struct PressedPoint {
  Vec3 x, normal;
  double area;
};

/// Returns the axis about which faces turn into themselves, of both sides of a zone, through `centre` where its
/// position is not determined (flat faces). None: there is none, or more than one (spheres). across: direction of plane
/// strain.
std::optional<TorqueCapacity> axis_of_faces(const std::array<std::vector<PressedPoint>, 2>& sides, const Vec3& centre,
                                            const std::optional<Vec3>& across);

}  // namespace cgcontact
