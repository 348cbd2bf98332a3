/// Edges of a list of triangles, and ways across them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// One use of an edge: by `triangle`, from its corner `corner` to the next.
struct EdgeUse {
  int triangle, corner;
};

/// Calls use(uses) for every edge with the triangles that have it, ascending. Edges come by their lower point, then by
/// the other one.
template <class Use>
void each_edge(const std::vector<Triangle>& triangles, std::size_t num_points, const Use& use) {
  struct Entry {
    int other;  ///< point at the other end
    EdgeUse edge;
  };
  std::vector<std::size_t> begin(num_points + 1, 0);
  for (const Triangle& t : triangles)
    for (int e = 0; e < 3; ++e) ++begin[static_cast<std::size_t>(std::min(t[e], t[(e + 1) % 3])) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Entry> entries(3 * triangles.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(triangles[t][e], triangles[t][(e + 1) % 3]);
      entries[next[low]++] = {high, {static_cast<int>(t), e}};
    }
  std::vector<EdgeUse> uses;
  for (std::size_t p = 0; p < num_points; ++p) {
    const auto first = entries.begin() + static_cast<std::ptrdiff_t>(begin[p]);
    const auto last = entries.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]);
    std::sort(first, last, [](const Entry& a, const Entry& b) {
      return std::tie(a.other, a.edge.triangle, a.edge.corner) < std::tie(b.other, b.edge.triangle, b.edge.corner);
    });
    for (auto i = first; i != last;) {
      uses.clear();
      const int other = i->other;
      for (; i != last && i->other == other; ++i) uses.push_back(i->edge);
      use(uses);
    }
  }
}

/// Marks all triangles that are reached from `first` across edges that pass(from, to).
template <class Pass, class Mark>
void flood(const std::vector<std::array<int, 3>>& neighbours, int first, const Pass& pass, const Mark& mark) {
  std::vector<int> stack{first};
  mark(first);
  while (!stack.empty()) {
    const int t = stack.back();
    stack.pop_back();
    for (int other : neighbours[t]) {
      if (other < 0 || !pass(t, other)) continue;
      mark(other);
      stack.push_back(other);
    }
  }
}

/// Returns radians, 0 to pi.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace cgcontact
