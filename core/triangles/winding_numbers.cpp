#include "core/triangles/winding_numbers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace cgcontact {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr int leaf_size = 8;
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
    : points_(points), triangles_(triangles), passes_(passes), order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  const auto centre = [&](int t) -> Vec3 {
    return points[triangles[t][0]] + points[triangles[t][1]] + points[triangles[t][2]];
  };
  struct Task {
    int begin, end, parent;
  };
  std::vector<Task> tasks;
  if (!order_.empty()) tasks.push_back({0, static_cast<int>(order_.size()), -1});
  while (!tasks.empty()) {
    const auto [begin, end, parent] = tasks.back();
    tasks.pop_back();
    const int number = static_cast<int>(nodes_.size());
    if (parent >= 0) nodes_[parent].right = number;
    nodes_.push_back({-1, begin, end, Vec3::Zero(), 0});
    fill(nodes_.back());
    if (end - begin <= leaf_size) continue;
    Eigen::AlignedBox3d box;
    for (int i = begin; i < end; ++i) box.extend(centre(order_[i]));
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) { return centre(a)[axis] < centre(b)[axis]; });
    tasks.push_back({middle, end, number});  // the right child, numbered when the left one is complete
    tasks.push_back({begin, middle, -1});
  }
}

void WindingNumbers::fill(Node& node) const {
  double area = 0;
  for (Vec3& dipole : node.dipole) dipole.setZero();
  for (int i = node.begin; i < node.end; ++i) {
    const Triangle& t = triangles_[order_[i]];
    const Vec3 normal = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]) / 2;
    area += normal.norm();
    node.centre += normal.norm() * (points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3;
    for (std::size_t k = 0; k < num_surfaces; ++k) node.dipole[k] += passes_[order_[i]][k] * normal;
  }
  if (area > 0) node.centre /= area;
  for (int i = node.begin; i < node.end; ++i)
    for (const int p : triangles_[order_[i]]) node.radius = std::max(node.radius, (points_[p] - node.centre).norm());
}

std::array<double, WindingNumbers::num_surfaces> WindingNumbers::at(const Vec3& x, int left_out) const {
  std::array<double, num_surfaces> sum{};
  std::vector<int> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    const Node& node = nodes_[n];
    const Vec3 to = node.centre - x;
    const double distance = to.norm();
    if (distance > far * node.radius) {
      for (std::size_t k = 0; k < num_surfaces; ++k)
        sum[k] += node.dipole[k].dot(to) / (4 * pi * distance * distance * distance);
    } else if (node.right >= 0) {
      open.push_back(node.right);
      open.push_back(n + 1);
    } else {
      for (int i = node.begin; i < node.end; ++i) {
        if (order_[i] == left_out) continue;
        const Triangle& t = triangles_[order_[i]];
        const double angle = solid_angle(points_[t[0]] - x, points_[t[1]] - x, points_[t[2]] - x);
        for (std::size_t k = 0; k < num_surfaces; ++k) sum[k] += passes_[order_[i]][k] * angle;
      }
    }
  }
  return sum;
}

}  // namespace cgcontact
