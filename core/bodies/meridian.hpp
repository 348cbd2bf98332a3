/// The half-plane through the axis of a body of revolution, as a prism: what it is cut to in two dimensions.
#pragma once

#include "core/geometry/solid.hpp"

namespace cgcontact {

/// Half the thickness that meridians have, m; nothing depends on it.
constexpr double half_thickness_of_meridian = 0.5;

/// The body whose section across the axis is that of `solid` in the half-plane of the next axis (about z: x >= 0, about
/// x: y >= 0, about y: z >= 0) and the same everywhere else, from -half_thickness_of_meridian to +. Surfaces keep their
/// names; "axis.plane" is what lies on the axis. A prism across the half-plane is its own section. Throws InputError
/// that names the surface that is not of revolution about the axis (the coordinate `axis` through the origin).
Solid meridian_of(const Solid& solid, int axis);

}  // namespace cgcontact
