/// Indentation of an elastic half-space by a convex punch of any shape, from the overlap of the undeformed bodies with
/// volume V and area A: F = 1.07 E* V / sqrt(A) times a factor for long overlaps. Within 6 % for spheres, cones and
/// flat punches (Johnson, Contact Mechanics, sections 3.3, 4.2, 5.2; derivation and figures in docs/theory.md).
#pragma once

#include <utility>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// 1.064 for spheres, 1.077 for cones, 1.13 for flat punches.
constexpr double indentation = 1.07;
/// Line contact: F = 3 pi / 4 E* V / width makes the overlap of cylinders as wide as Hertz's zone under the force.
constexpr double line_indentation = 0.75 * pi;
/// Width of a contact zone over that of the overlap: 0.71 for spheres, 0.64 for cones and wedges.
constexpr double width_of_overlap = 0.7;

/// Returns the long and the short axis of the ellipse with these moments (of order 0, 1, 2), m.
std::pair<double, double> axes_of_overlap(double area, const Vec3& first, const Mat3& second);

/// Returns E* of two bodies, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, Pa.
double effective_modulus(const Material& a, const Material& b);

/// Stiffness of an elliptic punch over that of a circular one of the same area; aspect: of its axes, >= 1 (Johnson,
/// section 3.6, equation 3.70).
double slenderness_factor(double aspect);

}  // namespace cgcontact
