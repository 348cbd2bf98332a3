#include "core/triangles/polygon_triangles.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace cgcontact {
namespace {

using Corner = Eigen::Vector2d;

double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Returns whether corner k of the ring is an ear: convex, and no other corner in the triangle that it makes.
bool is_ear(const std::vector<Corner>& x, const std::vector<int>& ring, std::size_t k, double flat) {
  const std::size_t n = ring.size();
  const int a = ring[(k + n - 1) % n], b = ring[k], c = ring[(k + 1) % n];
  if (turn(x[a], x[b], x[c]) <= flat) return false;
  return std::none_of(ring.begin(), ring.end(), [&](int p) {
    if (x[p] == x[a] || x[p] == x[b] || x[p] == x[c]) return false;  // rings that touch themselves
    return turn(x[a], x[b], x[p]) >= 0 && turn(x[b], x[c], x[p]) >= 0 && turn(x[c], x[a], x[p]) >= 0;
  });
}

std::vector<Triangle> fan(int n) {
  std::vector<Triangle> triangles;
  for (int k = 1; k + 1 < n; ++k) triangles.push_back({0, k, k + 1});
  return triangles;
}

}  // namespace

std::vector<Triangle> polygon_triangles(const std::vector<Vec3>& corners) {
  const int n = static_cast<int>(corners.size());
  if (n < 3) return {};
  Vec3 normal = Vec3::Zero();
  const auto term = [&](int k) { return Vec3((corners[k] - corners[0]).cross(corners[k + 1] - corners[0])); };
  double norms = 0;
  for (int k = 1; k + 1 < n; ++k) {
    normal += term(k);
    norms += term(k).norm();
  }
  if (normal.norm() < 1e-14 * norms) return {};
  bool is_fan = true;
  for (int k = 1; k + 1 < n; ++k) is_fan = is_fan && term(k).dot(normal) >= 0;
  if (is_fan) return fan(n);
  const double area = normal.norm();
  if (!(area > 0)) return {};
  const Vec3 s = (normal / area).unitOrthogonal(), t = (normal / area).cross(s);
  std::vector<Corner> x;
  for (const Vec3& corner : corners) x.emplace_back(s.dot(corner - corners[0]), t.dot(corner - corners[0]));
  std::vector<int> ring(n);
  std::iota(ring.begin(), ring.end(), 0);
  std::vector<Triangle> triangles;
  const double flat = 1e-14 * area;
  std::size_t next = 0;
  while (ring.size() > 3) {
    std::size_t tried = 0;
    for (next %= ring.size(); tried < ring.size() && !is_ear(x, ring, next, flat); ++tried)
      next = (next + 1) % ring.size();
    if (tried == ring.size()) {
      // Corners on straight edges are no ears; those without any area may go as triangles without area.
      const auto straight = [&](std::size_t k) {
        const std::size_t m = ring.size();
        return std::abs(turn(x[ring[(k + m - 1) % m]], x[ring[k]], x[ring[(k + 1) % m]])) <= flat;
      };
      for (next = 0; next < ring.size() && !straight(next); ++next) {
      }
      if (next == ring.size()) return {};
    }
    const std::size_t m = ring.size();
    triangles.push_back({ring[(next + m - 1) % m], ring[next], ring[(next + 1) % m]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(next));
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  double sum = 0;
  for (const Triangle& c : triangles) sum += std::abs(turn(x[c[0]], x[c[1]], x[c[2]]));
  return std::abs(sum - area) <= 1e-9 * area ? triangles : std::vector<Triangle>{};
}

}  // namespace cgcontact
