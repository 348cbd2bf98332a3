#include "core/triangle_surface.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

namespace {

/// Nearest point of a triangle, and where it lies: 0 inside, 1 + e on the edge from corner e, 4 + k at corner k.
/// Voronoi regions as in Ericson, Real-Time Collision Detection (2005), section 5.1.5.
Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c, int& feature) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return feature = 4, a;
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return feature = 5, b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return feature = 1, Vec3(a + d1 / (d1 - d3) * ab);
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return feature = 6, c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return feature = 3, Vec3(a + d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return feature = 2, Vec3(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  feature = 0;
  const double scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

std::vector<std::array<int, 3>> edge_neighbours(const std::vector<Triangle>& triangles, std::size_t num_points) {
  // Edges by their lower point, so that the edges to compare lie together.
  std::vector<std::size_t> begin(num_points + 1, 0);
  const auto lower = [&](std::size_t t, int e) { return std::min(triangles[t][e], triangles[t][(e + 1) % 3]); };
  const auto upper = [&](std::size_t t, int e) { return std::max(triangles[t][e], triangles[t][(e + 1) % 3]); };
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int e = 0; e < 3; ++e) ++begin[lower(t, e) + 1];
  for (std::size_t p = 0; p < num_points; ++p) begin[p + 1] += begin[p];
  std::vector<std::pair<int, int>> edges(3 * triangles.size());  // triangle, corner
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int e = 0; e < 3; ++e) edges[next[lower(t, e)]++] = {static_cast<int>(t), e};

  std::vector<std::array<int, 3>> neighbours(triangles.size(), {-1, -1, -1});
  for (std::size_t p = 0; p < num_points; ++p)
    for (std::size_t i = begin[p]; i < begin[p + 1]; ++i) {
      const auto [t, e] = edges[i];
      int found = -1, count = 0;
      for (std::size_t j = begin[p]; j < begin[p + 1]; ++j) {
        if (j == i || upper(edges[j].first, edges[j].second) != upper(t, e)) continue;
        found = edges[j].first;
        ++count;
      }
      if (count == 1) neighbours[t][e] = found;
    }
  return neighbours;
}

TriangleSurface::TriangleSurface(std::vector<Vec3> points, std::vector<Triangle> triangles, std::vector<int> patch,
                                 std::vector<std::string> face_names)
    : points_(std::move(points)) {
  auto topology = std::make_shared<Topology>();
  topology->neighbours = edge_neighbours(triangles, points_.size());
  topology->triangles = std::move(triangles);
  topology->patch = std::move(patch);
  topology->face_names = std::move(face_names);
  topology_ = topology;
  tree_ = TriangleTree(points_, topology_->triangles);
  find_normals();
}

void TriangleSurface::find_normals() {
  normals_.resize(triangles().size());
  point_normals_.assign(points_.size(), Vec3::Zero());
  for (std::size_t t = 0; t < normals_.size(); ++t) {
    const Triangle& corners = triangles()[t];
    const Vec3 &a = points_[corners[0]], &b = points_[corners[1]], &c = points_[corners[2]];
    normals_[t] = (b - a).cross(c - a).normalized();
    point_normals_[corners[0]] += angle_between(b - a, c - a) * normals_[t];
    point_normals_[corners[1]] += angle_between(c - b, a - b) * normals_[t];
    point_normals_[corners[2]] += angle_between(a - c, b - c) * normals_[t];
  }
}

TriangleSurface TriangleSurface::transformed(const Mat3& rotation, const Vec3& translation, double scale) const {
  TriangleSurface result = *this;
  for (Vec3& x : result.points_) x = (scale * (rotation * x) + translation).eval();
  result.tree_.refit(result.points_, triangles());
  result.find_normals();
  return result;
}

Vec3 TriangleSurface::mean_normal(int triangle, int feature) const {
  if (feature == 0) return normals_[triangle];
  if (feature >= 4) return point_normals_[topology_->triangles[triangle][feature - 4]];
  const int other = topology_->neighbours[triangle][feature - 1];
  return other < 0 ? normals_[triangle] : Vec3(normals_[triangle] + normals_[other]);
}

TriangleSurface::Foot TriangleSurface::nearest(const Vec3& x, int patch, double limit) const {
  Foot best;
  int best_feature = 0;
  double least = limit * limit;
  tree_.visit_nearest(
      x, [&] { return least; },
      [&](int t) {
        if (patch >= 0 && topology_->patch[t] != patch) return;
        int feature = 0;
        const Vec3 point = nearest_on_triangle(x, corner(t, 0), corner(t, 1), corner(t, 2), feature);
        const double distance = (x - point).squaredNorm();
        if (distance > least || (distance == least && best.triangle >= 0)) return;
        least = distance;
        best.triangle = t;
        best.point = point;
        best_feature = feature;
      });
  if (best.triangle < 0) return best;
  best.distance = std::sqrt(least);
  best.normal = mean_normal(best.triangle, best_feature);
  return best;
}

int TriangleSurface::nearest_facing(const Vec3& x, const Vec3& n) const {
  int best = -1;
  double least = 1e300;
  tree_.visit_nearest(
      x, [&] { return least * least; },
      [&](int t) {
        int feature = 0;
        const Vec3 point = nearest_on_triangle(x, corner(t, 0), corner(t, 1), corner(t, 2), feature);
        const double misfit = (x - point).norm() + (1 - normals_[t].dot(n));
        if (misfit >= least) return;
        least = misfit;
        best = t;
      });
  return best;
}

bool TriangleSurface::contains(const Vec3& x) const {
  if ((x.array() < tree_.min().array()).any() || (x.array() > tree_.max().array()).any()) return false;
  const Foot foot = nearest(x);
  return (x - foot.point).dot(foot.normal) <= 0;
}

bool TriangleSurface::meets(const Vec3& x, const Vec3& d, int triangle, double& t) const {
  const Vec3 &a = corner(triangle, 0), u = corner(triangle, 1) - a, v = corner(triangle, 2) - a;
  const Vec3 n = u.cross(v);
  const double slope = n.dot(d);
  if (slope == 0) return false;
  t = n.dot(a - x) / slope;
  const Vec3 y = x + t * d - a;
  const double inverse = 1 / n.squaredNorm(), beta = n.dot(y.cross(v)) * inverse, gamma = n.dot(u.cross(y)) * inverse;
  return beta >= -hit_tolerance && gamma >= -hit_tolerance && beta + gamma <= 1 + hit_tolerance;
}

}  // namespace cgcontact
