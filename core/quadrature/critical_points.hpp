/// Points common to three quadrics, by Newton's method from several starts.
#pragma once

#include <vector>

#include "core/quadrature/region.hpp"

namespace cgcontact {

/// Embeds a conic as a cylinder over it.
Quadric cylinder_over(const Conic& conic);

/// Returns u[axis] - position.
Quadric coordinate_plane(int axis, double position);

/// Returns the function whose zero on the curve a = b = 0 says that the curve's tangent has no component along
/// `direction` (or that the curve crosses itself).
Quadric tangency_function(const Quadric& a, const Quadric& b, int direction);

/// Replaces `points` by the points common to a, b and c near the cube [0,w]^3 that were found from the starts.
void common_points(const Quadric& a, const Quadric& b, const Quadric& c, double w, const std::vector<Vec3>& starts,
                   std::vector<Vec3>& points);

}  // namespace cgcontact
