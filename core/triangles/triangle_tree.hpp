/// Bounding-volume tree over triangles, for searches by box, by line and by distance. Its topology survives rigid
/// motions: only the boxes are fitted again.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Corners as indices into a list of points, counterclockwise seen from outside.
using Triangle = std::array<int, 3>;

/// Triangles in halves, these in halves again, and so on: divided across the longest side of the box around their
/// centres.
struct TriangleHalves {
  /// A leaf has right < 0; the left child follows its parent.
  struct Node {
    int right, begin, end;  ///< its triangles: a range of `order`
  };
  /// Leaves have at most `leaf_size` triangles.
  TriangleHalves(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, int leaf_size);

  std::vector<int> order;   ///< triangles, those of a node together
  std::vector<Node> nodes;  ///< at least the root
};

class TriangleTree {
 public:
  TriangleTree() = default;
  /// `group`: of every triangle, >= 0; none: all are of one group.
  TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
               const std::vector<int>& group = {});

  /// Refits the tree to moved points.
  void refit(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  const Vec3& min() const { return boxes_.front().min; }
  const Vec3& max() const { return boxes_.front().max; }

  /// Calls use(triangle) for all triangles in leaves whose boxes (corners min, max) enter(min, max) accepts.
  template <class Enter, class Use>
  void visit(const Enter& enter, const Use& use) const {
    int stack[max_depth], size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const int n = stack[--size];
      if (!enter(boxes_[n].min, boxes_[n].max)) continue;
      const TriangleHalves::Node& node = topology_->halves.nodes[n];
      if (node.right < 0) {
        for (int i = node.begin; i < node.end; ++i) use(topology_->halves.order[i]);
      } else {
        stack[size++] = node.right;
        stack[size++] = n + 1;
      }
    }
  }

  /// Calls use(triangle) for triangles that may be nearer to x than sqrt(limit()), nearer boxes first; use may lower
  /// the limit. Boxes without a triangle of the group (-1: any) are passed over.
  template <class Limit, class Use>
  void visit_nearest(const Vec3& x, int group, const Limit& limit, const Use& use) const {
    std::pair<double, int> stack[max_depth];
    int size = 0;
    stack[size++] = {squared_distance(0, x), 0};
    while (size > 0) {
      const auto [distance, n] = stack[--size];
      if (distance > limit()) continue;
      const int group_of_node = topology_->group_of_node[n];
      if (group >= 0 && group_of_node >= 0 && group_of_node != group) continue;
      const TriangleHalves::Node& node = topology_->halves.nodes[n];
      if (node.right < 0) {
        for (int i = node.begin; i < node.end; ++i) use(topology_->halves.order[i]);
        continue;
      }
      std::pair<double, int> near{squared_distance(n + 1, x), n + 1}, far{squared_distance(node.right, x), node.right};
      if (far.first < near.first) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
    }
  }

 private:
  static constexpr int max_depth = 128;  ///< halves are equal: 31 levels for all triangles an int can number
  struct Box {
    Vec3 min, max;
  };
  struct Topology {
    TriangleHalves halves;
    std::vector<int> group_of_node;  ///< of all triangles of the node, -1: they are of several
  };

  double squared_distance(int node, const Vec3& x) const {
    return (boxes_[node].min - x).cwiseMax(x - boxes_[node].max).cwiseMax(0.0).squaredNorm();
  }

  std::shared_ptr<const Topology> topology_;
  std::vector<Box> boxes_;
};

}  // namespace cgcontact
