/// Pressure of a contact zone of few cells across: the root of a quadratic function of the place, as under Hertz's
/// contacts (an ellipse, also one that symmetry planes cut), from the forces that the contact transmits.
///
/// In such zones the sums of recovery/zone_edge/edge_fit.hpp reach across the whole zone, and the border between closed
/// and open points has no direction. Their force, its centre and its second moments are about right all the same.
/// Evidence: docs/recovery.md.
#pragma once

#include "recovery/zone_edge/edge_fit.hpp"

namespace cgcontact {

struct NarrowZone {
  Vec3 centre, axis[2], normal;  ///< m; unit tangents and normal of the contact face, global axes
  double cell_size = 0;          ///< m
  /// Of 1, x, y, x^2, x y, y^2 (cells from the centre): square of the pressure, Scales::stress squared.
  Eigen::Matrix<double, 6, 1> coefficients = Eigen::Matrix<double, 6, 1>::Zero();
  /// What the profile leaves of the forces' fourth moment about the middle, per force times radius^4: 0.005 for
  /// Hertz's on two to eight cells over the radius, 0.02 to 0.04 under a punch with a flat middle.
  double misfit = 0;
  double deficit = 0;  ///< cells that its edges are moved outwards by, without a change of the force

  /// The edge nearest to x (m, global axes), looked for from `start` on. False where the function has no zero near.
  bool edge_near(const Vec3& x, const Vec3& start, EdgePiece& piece) const;
};

/// How far around the middle of a zone forces count, cells; from narrow_zone_full on less and less.
constexpr double narrow_zone_full = 6, narrow_zone_reach = 9;
double narrow_zone_weight(double distance);

/// The zone with the moments up to the second of the forces around `centre`; stress_unit: Pa. False if there is none
/// (coefficients zero), or none whose closed and open parts are about those of the points.
bool fit_narrow_zone(const std::vector<const TransmittedForce*>& forces, const Vec3& centre, const Vec3& normal,
                     double cell_size, double stress_unit, NarrowZone& zone, const EdgeOptions& options = {});

}  // namespace cgcontact
