#include "core/triangles/winding_numbers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

constexpr int triangles_per_leaf = 8;
/// Radii from which a cluster is a dipole: the error of a winding number is about 1 / far^3 of the sum of all angles.
constexpr double far = 4;

/// The angle under which a triangle is seen, over 4 pi; positive from behind (Van Oosterom, Strackee 1983).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb) / (2 * pi);
}

}  // namespace

WindingNumbers::WindingNumbers(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                               const std::vector<Passes>& passes)
    : points_(points), triangles_(triangles), passes_(passes), halves_(points, triangles, triangles_per_leaf) {
  for (const TriangleHalves::Node& node : halves_.nodes) clusters_.push_back(cluster(node));
}

WindingNumbers::Cluster WindingNumbers::cluster(const TriangleHalves::Node& node) const {
  Cluster cluster;
  double area = 0;
  for (Vec3& dipole : cluster.dipole) dipole.setZero();
  for (int i = node.begin; i < node.end; ++i) {
    const int number = halves_.order[i];
    const Triangle& t = triangles_[number];
    const Vec3 normal = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]) / 2;
    area += normal.norm();
    cluster.centre += normal.norm() * (points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3;
    for (std::size_t k = 0; k < num_surfaces; ++k) cluster.dipole[k] += passes_[number][k] * normal;
  }
  if (area > 0) cluster.centre /= area;
  for (int i = node.begin; i < node.end; ++i)
    for (const int p : triangles_[halves_.order[i]])
      cluster.radius = std::max(cluster.radius, (points_[p] - cluster.centre).norm());
  return cluster;
}

std::array<double, WindingNumbers::num_surfaces> WindingNumbers::at(const Vec3& x, int left_out) const {
  std::array<double, num_surfaces> sum{};
  std::vector<int> open{0};
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    const TriangleHalves::Node& node = halves_.nodes[n];
    const Cluster& cluster = clusters_[n];
    const Vec3 to = cluster.centre - x;
    const double distance = to.norm();
    if (distance > far * cluster.radius) {
      for (std::size_t k = 0; k < num_surfaces; ++k)
        sum[k] += cluster.dipole[k].dot(to) / (4 * pi * distance * distance * distance);
    } else if (node.right >= 0) {
      open.push_back(node.right);
      open.push_back(n + 1);
    } else {
      for (int i = node.begin; i < node.end; ++i) {
        if (halves_.order[i] == left_out) continue;
        const Triangle& t = triangles_[halves_.order[i]];
        const double angle = solid_angle(points_[t[0]] - x, points_[t[1]] - x, points_[t[2]] - x);
        for (std::size_t k = 0; k < num_surfaces; ++k) sum[k] += passes_[halves_.order[i]][k] * angle;
      }
    }
  }
  return sum;
}

}  // namespace cgcontact
