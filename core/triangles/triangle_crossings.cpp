#include "core/triangles/triangle_crossings.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/process/parallel.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

namespace {

/// Bound of the rounding error of the determinant, relative to the sum of the sizes of its terms
/// (Shewchuk, Adaptive precision floating-point arithmetic, 1997: (7 + 56 eps) eps, eps = 1.1e-16).
constexpr double determinant_error = 1e-15;
/// Error of coordinates relative to the largest: unit, placement and intersections have rounded them.
constexpr double coordinate_error = 4e-16;

/// Side of the plane a, b, c on which d lies: -1, 1, or 0 if rounding decides. `error`: of the coordinates.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double error) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double p = v[0] * w[1], q = v[1] * w[0], r = w[0] * u[1], s = w[1] * u[0], x = u[0] * v[1], y = u[1] * v[0];
  const double determinant = u[2] * (p - q) + v[2] * (r - s) + w[2] * (x - y);
  const double size = std::abs(u[2]) * (std::abs(p) + std::abs(q)) + std::abs(v[2]) * (std::abs(r) + std::abs(s)) +
                      std::abs(w[2]) * (std::abs(x) + std::abs(y));
  const double lu = u.lpNorm<1>(), lv = v.lpNorm<1>(), lw = w.lpNorm<1>();
  if (std::abs(determinant) <= determinant_error * size + error * (lu * lv + lv * lw + lw * lu)) return 0;
  return determinant < 0 ? -1 : 1;
}

class CrossingFinder {
 public:
  CrossingFinder(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
      : points_(points),
        triangles_(triangles),
        neighbours_(edge_neighbours(triangles, points.size())),
        tree_(points, triangles) {
    for (const Vec3& x : points) error_ = std::max(error_, coordinate_error * x.lpNorm<Eigen::Infinity>());
  }

  std::vector<std::pair<int, int>> run() const {
    std::vector<std::vector<std::pair<int, int>>> found(num_chunks(triangles_.size(), grain_of_medium));
    parallel_chunks("cgcontact::triangle_crossings::search", triangles_.size(), grain_of_medium,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      for (std::size_t t = begin; t < end; ++t) look_around(static_cast<int>(t), found[chunk]);
                    });
    std::vector<std::pair<int, int>> pairs;
    for (const auto& chunk : found) pairs.insert(pairs.end(), chunk.begin(), chunk.end());
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  void look_around(int t, std::vector<std::pair<int, int>>& found) const {
    Vec3 low = points_[triangles_[t][0]], high = low;
    for (int p : triangles_[t]) {
      low = low.cwiseMin(points_[p]);
      high = high.cwiseMax(points_[p]);
    }
    tree_.visit(
        [&](const Vec3& min, const Vec3& max) {
          return (min.array() <= high.array()).all() && (max.array() >= low.array()).all();
        },
        [&](int other) {
          if (other > t && cross(t, other)) found.push_back({t, other});
        });
  }

  bool cross(int a, int b) const {
    const Triangle &s = triangles_[a], &t = triangles_[b];
    int shared = 0;
    for (int p : s) shared += std::count(t.begin(), t.end(), p);
    if (shared == 3) return true;
    if (shared == 2) return is_folded(s, t);
    return any_edge_passes(s, b) || any_edge_passes(t, a);
  }

  /// Returns whether the segment from p to q passes from one side of the triangle to the other: through a point on its
  /// edges if it passes through all triangles there in the same sense.
  bool passes(int p, int q, int t) const {
    const int sense = side_of(t, p);
    if (sense == 0 || side_of(t, q) != -sense) return false;
    const auto passes_plane = [&](int other) {
      return other >= 0 && side_of(other, p) == sense && side_of(other, q) == -sense;
    };
    int turn[3];
    for (int e = 0; e < 3; ++e) turn[e] = side_of(p, q, triangles_[t][e], triangles_[t][(e + 1) % 3]);
    const auto [least, most] = std::minmax_element(turn, turn + 3);
    if ((*least < 0) == (*most > 0)) return false;
    for (int e = 0; e < 3; ++e) {
      if (turn[e] != 0) continue;
      if (!passes_plane(neighbours_[t][e])) return false;
      if (turn[(e + 1) % 3] == 0 && !all_around(t, (e + 1) % 3, passes_plane)) return false;
    }
    return true;
  }

  /// Returns whether the test holds for all triangles around a corner.
  template <class Test>
  bool all_around(int t, int corner, const Test& test) const {
    const int point = triangles_[t][corner];
    for (int now = neighbours_[t][corner]; now != t;) {
      if (now < 0 || !test(now)) return false;
      const auto k = std::find(triangles_[now].begin(), triangles_[now].end(), point) - triangles_[now].begin();
      now = neighbours_[now][k];
    }
    return true;
  }

  int side_of(int a, int b, int c, int d) const {
    return side_of_plane(points_[a], points_[b], points_[c], points_[d], error_);
  }
  int side_of(int t, int p) const { return side_of(triangles_[t][0], triangles_[t][1], triangles_[t][2], p); }

  /// Edges without a corner of the other triangle.
  bool any_edge_passes(const Triangle& from, int through) const {
    const Triangle& corners = triangles_[through];
    const auto is_shared = [&](int p) { return std::find(corners.begin(), corners.end(), p) != corners.end(); };
    for (int e = 0; e < 3; ++e) {
      const int p = from[e], q = from[(e + 1) % 3];
      if (is_shared(p) || is_shared(q)) continue;
      if (passes(p, q, through)) return true;
    }
    return false;
  }

  /// Two triangles at an edge that lie on each other.
  bool is_folded(const Triangle& s, const Triangle& t) const {
    const auto other_corner = [](const Triangle& of, const Triangle& than) {
      return *std::find_if(of.begin(), of.end(),
                           [&](int p) { return std::find(than.begin(), than.end(), p) == than.end(); });
    };
    const auto normal = [&](const Triangle& c) {
      return Vec3((points_[c[1]] - points_[c[0]]).cross(points_[c[2]] - points_[c[0]]));
    };
    if (side_of(s[0], s[1], s[2], other_corner(t, s)) != 0) return false;
    return normal(s).dot(normal(t)) < 0;
  }

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  const std::vector<std::array<int, 3>> neighbours_;
  const TriangleTree tree_;
  double error_ = 0;  ///< of coordinates
};

}  // namespace

std::vector<std::pair<int, int>> find_crossings(const std::vector<Vec3>& points,
                                                const std::vector<Triangle>& triangles) {
  return CrossingFinder(points, triangles).run();
}

}  // namespace cgcontact
