#include "recovery/contact_edge.hpp"

#include <cmath>

namespace cgcontact {

/// Westergaard's form with Z = sqrt(z), z = inside + i depth: sigma_xx = Re Z - y Im Z', sigma_yy = Re Z + y Im Z',
/// sigma_xy = -y Re Z', sigma_zz = 2 nu Re Z; x into the zone, y into the body.
void ContactEdge::stress(const Vec3& x, double s[6]) const {
  const Vec3 inward = -orientation * surface.gradient(x);
  const double across = inside(x), depth = std::max(-orientation * surface.signed_distance(x) * scale, 0.0);
  const double radius = std::sqrt(across * across + depth * depth);
  const double real = std::sqrt(std::max(radius + across, 0.0) / 2), imaginary = std::sqrt(std::max(radius - across, 0.0) / 2);
  // depth times Z' = depth / (2 sqrt(z)), which tends to zero with the radius
  const double ratio = radius > 0 ? depth / (2 * radius) : 0.0;
  const double slope_real = ratio * real, slope_imaginary = -ratio * imaginary;
  const double along = real - slope_imaginary, normal = real + slope_imaginary, shear = -slope_real,
               third = 2 * poisson_ratio * real;
  const Vec3 e = (closed - closed.dot(inward) * inward).normalized(), t = inward.cross(e);
  constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
  for (int k = 0; k < 6; ++k) {
    const int i = first[k], j = second[k];
    s[k] = along * e[i] * e[j] + normal * inward[i] * inward[j] + shear * (e[i] * inward[j] + inward[i] * e[j]) +
           third * t[i] * t[j];
  }
}

}  // namespace cgcontact
