#include "recovery/patch/contact_edge.hpp"

namespace cgcontact {

void ContactEdge::stress(const Vec3& x, double s[6]) const {
  const Vec3 inward = -orientation * surface.gradient(x);
  const double depth = std::max(-orientation * surface.signed_distance(x) * scale, 0.0);
  double across, normal, shear;
  edge_term(inside(x), depth, inverse_width / scale, across, normal, shear);
  const double third = poisson_ratio * (across + normal);
  const Vec3 gradient = closed + curvature * along.dot(x - origin) * along;
  const Vec3 e = (gradient - gradient.dot(inward) * inward).normalized(), t = inward.cross(e);
  constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
  for (int k = 0; k < 6; ++k) {
    const int i = first[k], j = second[k];
    s[k] = across * e[i] * e[j] + normal * inward[i] * inward[j] + shear * (e[i] * inward[j] + inward[i] * e[j]) +
           third * t[i] * t[j];
  }
}

}  // namespace cgcontact
