#include "core/geometry/surface.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

Vec3 radial(const Surface& surface, const Vec3& x) {
  const Vec3 d = x - surface.point;
  return d - d.dot(surface.direction) * surface.direction;
}

double height(const Surface& cone, const Vec3& x) { return (x - cone.point).dot(cone.direction); }

double Surface::signed_distance(const Vec3& x) const {
  switch (kind) {
    case Kind::plane:
      return direction.dot(x - point);
    case Kind::sphere:
      return (x - point).norm() - radius;
    case Kind::cylinder:
      return radial(*this, x).norm() - radius;
    case Kind::cone:
      return radial(*this, x).norm() * cosine - std::abs(height(*this, x)) * sine;
    case Kind::patch:
      return near(x).signed_distance(x);
  }
  return 0;
}

Surface Surface::near(const Vec3& x) const { return kind == Kind::patch ? patch->near(x) : *this; }

Vec3 Surface::gradient(const Vec3& x) const {
  if (kind == Kind::plane) return direction;
  if (kind == Kind::patch) return patch->normal(x);
  const Vec3 d = kind == Kind::sphere ? Vec3(x - point) : radial(*this, x);
  const double length = d.norm();
  const Vec3 outward = length > 0 ? Vec3(d / length) : direction.unitOrthogonal();
  if (kind != Kind::cone) return outward;
  return cosine * outward - std::copysign(sine, height(*this, x)) * direction;
}

double Surface::max_curvature(const Vec3& x, double reach) const {
  if (kind != Kind::cone) return max_curvature();
  return cosine / std::max(radial(*this, x).norm() - reach, reach);
}

namespace {

/// Parameters of the crossings with a cone; of a line along the cone there is one.
int intersect_cone(const Surface& cone, const Vec3& x, const Vec3& d, double t[2]) {
  const Vec3 r = radial(cone, x), e = d - d.dot(cone.direction) * cone.direction;
  const double h = height(cone, x), slope = d.dot(cone.direction), across = r.norm();
  const double a = (e.norm() * cone.cosine - slope * cone.sine) * (e.norm() * cone.cosine + slope * cone.sine);
  const double b = r.dot(e) * cone.cosine * cone.cosine - h * slope * cone.sine * cone.sine;
  const double c = (across * cone.cosine - h * cone.sine) * (across * cone.cosine + h * cone.sine);
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (std::isfinite(q / a)) t[count++] = q / a;
  if (q != 0) t[count++] = c / q;
  if (count == 2 && t[0] > t[1]) std::swap(t[0], t[1]);
  return count;
}

}  // namespace

int Surface::intersect_line(const Vec3& x, const Vec3& d, double t[2]) const {
  if (kind == Kind::patch) return 0;
  if (kind == Kind::plane) {
    const double slope = direction.dot(d);
    if (slope == 0) return 0;
    t[0] = direction.dot(point - x) / slope;
    return 1;
  }
  if (kind == Kind::cone) return intersect_cone(*this, x, d, t);
  const bool sphere = kind == Kind::sphere;
  const Vec3 r = sphere ? Vec3(x - point) : radial(*this, x);
  const Vec3 e = sphere ? d : Vec3(d - d.dot(direction) * direction);
  const double a = e.squaredNorm(), b = r.dot(e), c = (r.norm() - radius) * (r.norm() + radius);
  const double discriminant = b * b - a * c;
  if (a <= 1e-30 * d.squaredNorm() || discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t[0] = q / a;
  t[1] = q != 0 ? c / q : 0.0;
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return 2;
}

}  // namespace cgcontact
