#include "core/geometry/profile.hpp"

#include <cmath>

namespace cgcontact {

std::optional<Arc> arc_through(const Vec2& from, const Vec2& through, const Vec2& to, double flat) {
  const Vec2 u = through - from, v = to - from;
  const double twice_area = cross(u, v), u2 = u.squaredNorm(), v2 = v.squaredNorm();
  if (std::abs(twice_area) <= flat) return std::nullopt;
  const Vec2 to_centre = Vec2(v[1] * u2 - u[1] * v2, u[0] * v2 - v[0] * u2) / (2 * twice_area);
  const Vec2 end = v - to_centre;
  double turn = std::atan2(cross(-to_centre, end), -to_centre.dot(end));
  if (twice_area > 0 && turn <= 0) turn += 2 * pi;
  if (twice_area < 0 && turn >= 0) turn -= 2 * pi;
  return Arc{{from + to_centre, to_centre.norm()}, turn};
}

}  // namespace cgcontact
