#include "core/triangles/triangle_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace cgcontact {

namespace {

constexpr int leaf_size = 4;

}  // namespace

TriangleHalves::TriangleHalves(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, int leaf_size)
    : order(triangles.size()) {
  const int n = static_cast<int>(triangles.size());
  std::vector<Vec3> centre(n);
  for (int t = 0; t < n; ++t) centre[t] = points[triangles[t][0]] + points[triangles[t][1]] + points[triangles[t][2]];
  std::iota(order.begin(), order.end(), 0);
  struct Task {
    int begin, end, parent;
  };
  std::vector<Task> tasks{{0, n, -1}};
  while (!tasks.empty()) {
    const auto [begin, end, parent] = tasks.back();
    tasks.pop_back();
    const int number = static_cast<int>(nodes.size());
    if (parent >= 0) nodes[parent].right = number;
    nodes.push_back({-1, begin, end});
    if (end - begin <= leaf_size) continue;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (int i = begin; i < end; ++i) {
      low = low.cwiseMin(centre[order[i]]);
      high = high.cwiseMax(centre[order[i]]);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](int a, int b) { return centre[a][axis] < centre[b][axis]; });
    tasks.push_back({middle, end, number});  // the right child, numbered when the left one is complete
    tasks.push_back({begin, middle, -1});
  }
}

TriangleTree::TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<int>& group) {
  TriangleHalves halves(points, triangles, leaf_size);
  std::vector<int> group_of_node(halves.nodes.size());
  if (!group.empty())
    for (std::size_t n = 0; n < halves.nodes.size(); ++n) {
      const auto begin = halves.order.begin() + halves.nodes[n].begin, end = halves.order.begin() + halves.nodes[n].end;
      const bool alike = std::all_of(begin, end, [&](int t) { return group[t] == group[*begin]; });
      group_of_node[n] = alike ? group[*begin] : -1;
    }
  topology_ = std::make_shared<const Topology>(Topology{std::move(halves), std::move(group_of_node)});
  refit(points, triangles);
}

void TriangleTree::refit(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  const TriangleHalves& halves = topology_->halves;
  boxes_.resize(halves.nodes.size());
  for (int n = static_cast<int>(boxes_.size()) - 1; n >= 0; --n) {
    const TriangleHalves::Node& node = halves.nodes[n];
    Box& box = boxes_[n];
    if (node.right >= 0) {
      box.min = boxes_[n + 1].min.cwiseMin(boxes_[node.right].min);
      box.max = boxes_[n + 1].max.cwiseMax(boxes_[node.right].max);
      continue;
    }
    box.min = Vec3::Constant(std::numeric_limits<double>::max());
    box.max = -box.min;
    for (int i = node.begin; i < node.end; ++i)
      for (int p : triangles[halves.order[i]]) {
        box.min = box.min.cwiseMin(points[p]);
        box.max = box.max.cwiseMax(points[p]);
      }
  }
}

}  // namespace cgcontact
