/// Connected sets of points.
#pragma once

#include "core/base/numbers/point_buckets.hpp"

namespace cgcontact {

/// Returns for each point the first one of its connected set. position(i): m; joined(i, k): of neighbours, none
/// of which are farther apart than `reach`, m.
template <class PositionOf, class Joined>
std::vector<int> connected_sets(std::size_t count, double reach, const PositionOf& position, const Joined& joined) {
  PointBuckets near(reach);
  for (std::size_t i = 0; i < count; ++i) near.add(position(i), static_cast<int>(i));
  std::vector<int> first(count, -1), members;
  for (std::size_t i = 0; i < count; ++i) {
    if (first[i] >= 0) continue;
    members.assign(1, first[i] = static_cast<int>(i));
    for (std::size_t next = 0; next < members.size(); ++next) {
      const int from = members[next];
      near.each_near(position(from), [&](int k) {
        if (first[k] >= 0 || !joined(from, k)) return;
        first[k] = static_cast<int>(i);
        members.push_back(k);
      });
    }
  }
  return first;
}

}  // namespace cgcontact
