#include "core/drawing/conforming_boundary.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "core/base/numbers/point_buckets.hpp"

namespace cgcontact {

namespace {

/// Fraction of an edge's length within which points hang on it: small triangles of a curved surface lie beside the edge
/// of a large one.
constexpr double beside_edge = 0.05;
/// Open edges from an end of an edge to the points that hang on it: with points on both sides one leads beyond the end.
constexpr std::size_t max_open_edges = 4;

using Edge = std::uint64_t;

Edge edge_of(int a, int b) { return static_cast<Edge>(std::min(a, b)) << 32 | static_cast<Edge>(std::max(a, b)); }

/// Fraction of a cell within which points are one: cells of two sizes have points of their own where they meet.
constexpr double one_point = 1e-6;

/// Returns for each point of the boundary the first one at its position.
std::vector<int> welded(const DrawnBody& body) {
  std::vector<int> first(body.position.size(), -1);
  const double reach = one_point * body.mesh.cut_cells->grid.cell_size_of(body.mesh.cut_cells->num_levels() - 1);
  PointBuckets buckets(reach);
  for (const BoundaryTriangle& triangle : body.mesh.boundary)
    for (const int p : triangle.points) {
      if (first[p] >= 0) continue;
      buckets.any_near(body.position[p], [&](int other) {
        if ((body.position[other] - body.position[p]).norm() > reach) return false;
        first[p] = other;
        return true;
      });
      if (first[p] >= 0) continue;
      first[p] = p;
      buckets.add(body.position[p], p);
    }
  return first;
}

/// Edges that are not met by their opposites.
class OpenEdges {
 public:
  OpenEdges(const DrawnBody& body, const std::vector<ThinTriangle>& triangles) : body_(body) {
    std::unordered_map<Edge, int> balance;
    balance.reserve(2 * triangles.size());
    for (const ThinTriangle& triangle : triangles)
      for (int k = 0; k < 3; ++k) {
        const int a = triangle.points[k], b = triangle.points[(k + 1) % 3];
        balance[edge_of(a, b)] += a < b ? 1 : -1;
      }
    for (const auto& [edge, sum] : balance) {
      if (sum == 0) continue;
      const int a = static_cast<int>(edge >> 32), b = static_cast<int>(edge & 0xffffffff);
      beside_[a].push_back(b);
      beside_[b].push_back(a);
    }
  }

  bool any() const { return !beside_.empty(); }

  /// Points of open edges that lie on the edge from a to b, in this order.
  std::vector<int> hanging(int a, int b) const {
    std::vector<int> points;
    const auto found = beside_.find(a);
    if (found == beside_.end() || std::find(found->second.begin(), found->second.end(), b) == found->second.end())
      return points;
    const Vec3 &x = body_.position[a], way = body_.position[b] - x;
    const auto along = [&](int p) { return (body_.position[p] - x).dot(way) / way.squaredNorm(); };
    for (const int p : reached(a, b)) {
      const double t = along(p);
      if (t > 0 && t < 1 && (body_.position[p] - x - t * way).norm() < beside_edge * way.norm()) points.push_back(p);
    }
    std::sort(points.begin(), points.end(), [&](int p, int q) { return along(p) < along(q); });
    return points;
  }

 private:
  /// Points from which few open edges lead to a or b, without these.
  std::vector<int> reached(int a, int b) const {
    std::vector<int> points{a, b};
    for (std::size_t first = 0, steps = 0; steps < max_open_edges; ++steps) {
      const std::size_t last = points.size();
      for (; first < last; ++first)
        for (const int p : beside_.at(points[first]))
          if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
    }
    points.erase(points.begin(), points.begin() + 2);
    return points;
  }

  const DrawnBody& body_;
  std::unordered_map<int, std::vector<int>> beside_;  ///< of the points of such edges, their other ends
};

/// Divides a triangle at points on its edges: of edge k from corner k to the next, in this order.
void divide(const std::array<int, 3>& corners, const std::array<std::vector<int>, 3>& on, int source,
            std::vector<ThinTriangle>& triangles) {
  const int k = !on[0].empty() ? 0 : !on[1].empty() ? 1 : 2;
  if (on[k].empty()) {
    triangles.push_back({corners, source});
    return;
  }
  const int a = corners[k], b = corners[(k + 1) % 3], c = corners[(k + 2) % 3];
  const auto middle = on[k].begin() + static_cast<std::ptrdiff_t>(on[k].size() / 2);
  divide({a, *middle, c}, {std::vector<int>(on[k].begin(), middle), {}, on[(k + 2) % 3]}, source, triangles);
  divide({*middle, b, c}, {std::vector<int>(middle + 1, on[k].end()), on[(k + 1) % 3], {}}, source, triangles);
}

}  // namespace

std::vector<ThinTriangle> conforming_boundary(const DrawnBody& body) {
  const std::vector<int> point = welded(body);
  std::vector<ThinTriangle> whole;
  for (std::size_t i = 0; i < body.mesh.boundary.size(); ++i) {
    std::array<int, 3> corners = body.mesh.boundary[i].points;
    for (int& p : corners) p = point[p];
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      whole.push_back({corners, static_cast<int>(i)});
  }
  const OpenEdges open(body, whole);
  if (!open.any()) return whole;
  std::vector<ThinTriangle> triangles;
  for (const ThinTriangle& triangle : whole) {
    std::array<std::vector<int>, 3> on;
    for (int k = 0; k < 3; ++k) on[k] = open.hanging(triangle.points[k], triangle.points[(k + 1) % 3]);
    divide(triangle.points, on, triangle.source, triangles);
  }
  return triangles;
}

}  // namespace cgcontact
