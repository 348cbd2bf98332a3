#include "core/expressions/jump_planes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cgcontact {
namespace {

/// Points along each side of the box around which a comparison may be linear, and the fraction of the sides over which
/// it must be.
constexpr int samples = 4;
constexpr double around = 1e-3;
/// Fraction of the change over that distance that rounding leaves of a linear function. A curved one has about
/// `around`.
constexpr double linear = 1e-8;

/// The plane f = 0 of the linear function that f is around a point.
std::optional<JumpPlane> plane_around(const Expression& f, const Vec3& x, const Vec3& step) {
  const double middle = f(x);
  Vec3 gradient = Vec3::Zero();
  double largest = 0, bend = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = step[k] * Vec3::Unit(k);
    const double up = f(x + d) - middle, down = middle - f(x - d);
    gradient[k] = (up + down) / (2 * step[k]);
    largest = std::max({largest, std::abs(up), std::abs(down)});
    bend = std::max(bend, std::abs(up - down));
  }
  for (const Vec3& signs : {Vec3(1, 1, 1), Vec3(1, -1, 0.5), Vec3(-1, 0.5, 1)}) {  // products such as x y
    const Vec3 d = signs.cwiseProduct(step);
    bend = std::max(bend, std::abs(f(x + d) - middle - gradient.dot(d)));
  }
  if (!(largest > 0) || bend > linear * largest) return std::nullopt;
  const double length = gradient.norm();
  return JumpPlane{gradient / length, (gradient.dot(x) - middle) / length};
}

bool same(const JumpPlane& a, const JumpPlane& b, double size) {
  const double sign = a.normal.dot(b.normal) < 0 ? -1 : 1;
  return (sign * a.normal - b.normal).norm() < linear && std::abs(sign * a.offset - b.offset) < linear * size;
}

}  // namespace

std::vector<JumpPlane> jump_planes(const Expression& expression, const Vec3& min, const Vec3& max) {
  std::vector<JumpPlane> planes;
  const Vec3 extent = max - min;
  const double size = extent.norm();
  const auto add = [&](const Expression& f, const Vec3& x) {
    try {
      const auto plane = plane_around(f, x, around * extent);
      if (plane &&
          std::none_of(planes.begin(), planes.end(), [&](const JumpPlane& p) { return same(p, *plane, size); }))
        planes.push_back(*plane);
    } catch (const InputError&) {  // not finite there
    }
  };
  for (const Expression& f : expression.compared())
    for (int i = 0; i < samples * samples * samples; ++i) {
      const int x = i % samples, y = i / samples % samples, z = i / (samples * samples);
      const Vec3 sample(x + 0.53, y + 0.47, z + 0.51);
      add(f, min + extent.cwiseProduct(sample) / samples);
    }
  return planes;
}

}  // namespace cgcontact
