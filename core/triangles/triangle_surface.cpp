#include "core/triangles/triangle_surface.hpp"

#include <algorithm>
#include <cmath>

#include "core/triangles/triangle_edges.hpp"

namespace cgcontact {

/// Distinguishes Voronoi regions as in Ericson, Real-Time Collision Detection (2005), section 5.1.5.
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

std::vector<std::array<int, 3>> edge_neighbours(const std::vector<Triangle>& triangles, std::size_t num_points) {
  std::vector<std::array<int, 3>> neighbours(triangles.size(), {-1, -1, -1});
  each_edge(triangles, num_points, [&](const std::vector<EdgeUse>& uses) {
    if (uses.size() != 2) return;
    neighbours[uses[0].triangle][uses[0].corner] = uses[1].triangle;
    neighbours[uses[1].triangle][uses[1].corner] = uses[0].triangle;
  });
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
  tree_ = TriangleTree(points_, topology_->triangles, topology_->patch);
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

TriangleSurface TriangleSurface::stretched(int axis, double factor, double shift) const {
  TriangleSurface result = *this;
  for (Vec3& x : result.points_) x[axis] = factor * x[axis] + shift;
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
      x, patch, [&] { return least; },
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

/// Angle-weighted mean of the normals of the patch around a corner.
Vec3 TriangleSurface::corner_normal(int triangle, int k) const {
  const int point = topology_->triangles[triangle][k];
  const auto corner_index = [&](int t) {
    const Triangle& corners = topology_->triangles[t];
    return static_cast<int>(std::find(corners.begin(), corners.end(), point) - corners.begin());
  };
  const auto weighted = [&](int t) {
    const int i = corner_index(t);
    const Vec3& x = corner(t, i);
    return Vec3(angle_between(corner(t, (i + 1) % 3) - x, corner(t, (i + 2) % 3) - x) * normals_[t]);
  };
  const auto joined = [&](int t, int edge) {
    const int other = topology_->neighbours[t][edge];
    return other >= 0 && patch(other) == patch(triangle) ? other : -1;
  };
  Vec3 sum = weighted(triangle);
  int now = joined(triangle, k);
  for (; now >= 0 && now != triangle; now = joined(now, corner_index(now))) sum += weighted(now);
  if (now == triangle) return sum;
  // The patch ends on that side: go round the other way.
  for (now = joined(triangle, (k + 2) % 3); now >= 0; now = joined(now, (corner_index(now) + 2) % 3))
    sum += weighted(now);
  return sum;
}

Vec3 TriangleSurface::smooth_normal(int triangle, const Vec3& point) const {
  const Vec3 &a = corner(triangle, 0), u = corner(triangle, 1) - a, v = corner(triangle, 2) - a, x = point - a;
  const Vec3 n = u.cross(v);
  const double inverse = 1 / n.squaredNorm(), beta = n.dot(x.cross(v)) * inverse, gamma = n.dot(u.cross(x)) * inverse;
  return ((1 - beta - gamma) * corner_normal(triangle, 0).normalized() +
          beta * corner_normal(triangle, 1).normalized() + gamma * corner_normal(triangle, 2).normalized())
      .normalized();
}

int TriangleSurface::nearest_facing(const Vec3& x, const Vec3& n) const {
  int best = -1;
  double least = 1e300;
  tree_.visit_nearest(
      x, -1, [&] { return least * least; },
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
