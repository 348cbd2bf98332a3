#include "core/triangles/triangle_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace cgcontact {

namespace {

constexpr int leaf_size = 4;

}  // namespace

TriangleTree::TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<int>& group) {
  const int n = static_cast<int>(triangles.size());
  std::vector<Vec3> centre(n);
  for (int t = 0; t < n; ++t) centre[t] = points[triangles[t][0]] + points[triangles[t][1]] + points[triangles[t][2]];
  auto topology = std::make_shared<Topology>();
  topology->order.resize(n);
  std::iota(topology->order.begin(), topology->order.end(), 0);
  struct Task {
    int begin, end, parent;
  };
  std::vector<Task> tasks{{0, n, -1}};
  while (!tasks.empty()) {
    const auto [begin, end, parent] = tasks.back();
    tasks.pop_back();
    const int number = static_cast<int>(topology->nodes.size());
    if (parent >= 0) topology->nodes[parent].right = number;
    topology->nodes.push_back({-1, begin, end, group.empty() ? 0 : group[topology->order[begin]]});
    if (!group.empty() && std::any_of(topology->order.begin() + begin, topology->order.begin() + end,
                                      [&](int t) { return group[t] != topology->nodes[number].group; }))
      topology->nodes[number].group = -1;
    if (end - begin <= leaf_size) continue;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (int i = begin; i < end; ++i) {
      low = low.cwiseMin(centre[topology->order[i]]);
      high = high.cwiseMax(centre[topology->order[i]]);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    const auto first = topology->order.begin();
    std::nth_element(first + begin, first + middle, first + end,
                     [&](int a, int b) { return centre[a][axis] < centre[b][axis]; });
    tasks.push_back({middle, end, number});  // the right child, numbered when the left one is complete
    tasks.push_back({begin, middle, -1});
  }
  topology_ = topology;
  refit(points, triangles);
}

void TriangleTree::refit(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  boxes_.resize(topology_->nodes.size());
  for (int n = static_cast<int>(boxes_.size()) - 1; n >= 0; --n) {
    const Node& node = topology_->nodes[n];
    Box& box = boxes_[n];
    if (node.right >= 0) {
      box.min = boxes_[n + 1].min.cwiseMin(boxes_[node.right].min);
      box.max = boxes_[n + 1].max.cwiseMax(boxes_[node.right].max);
      continue;
    }
    box.min = Vec3::Constant(std::numeric_limits<double>::max());
    box.max = -box.min;
    for (int i = node.begin; i < node.end; ++i)
      for (int p : triangles[topology_->order[i]]) {
        box.min = box.min.cwiseMin(points[p]);
        box.max = box.max.cwiseMax(points[p]);
      }
  }
}

}  // namespace cgcontact
