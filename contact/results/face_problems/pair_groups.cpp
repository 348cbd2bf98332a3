#include "contact/results/face_problems/pair_groups.hpp"

#include <algorithm>

#include "core/base/process/parallel.hpp"
#include "recovery/face/connected_sets.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {
namespace {

/// Cells beyond the reach of a problem by which closed groups are apart in zones with problems of their own.
constexpr double apart = 1;

}  // namespace

PairGroups::PairGroups(const SolvedState& state, int pair, const double* group_force)
    : pair_(state.pairs[pair]), groups_(pair_.groups.size()) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].force = force_unit(state) * group_force[g];
    groups_[g].larger = pair_.groups[g].larger_cell;
  }
  std::vector<double> change(pair_.points.size());
  parallel_for("cgcontact::pair_groups::gaps", pair_.points.size(), 256, [&](std::size_t q) {
    const ContactPoint p = pair_.points[q];
    const Vec3 relative = displacement(state, pair_.secondary, p.secondary_cell, p.secondary_xi) -
                          displacement(state, pair_.primary, p.primary_cell, p.primary_xi);
    change[q] = relative.dot(p.normal);
  });
  for (std::size_t q = 0; q < pair_.points.size(); ++q) {
    GroupOnFace& group = groups_[pair_.points.group(q)];
    const double w = pair_.points.weight(q);
    group.area += w;
    group.centre += w * pair_.points.x(q);
    group.normal += w * pair_.points.normal(q);
    group.gap_change += w * change[q];
  }
  for (GroupOnFace& group : groups_) {
    if (!(group.area > 0)) continue;
    group.centre /= group.area;
    group.normal.normalize();
    group.gap_change /= group.area;
  }
}

std::vector<std::vector<int>> PairGroups::zones(double reach) const {
  std::vector<int> closed;
  double largest = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (groups_[g].closed() && groups_[g].area > 0) {
      closed.push_back(static_cast<int>(g));
      largest = std::max(largest, groups_[g].larger);
    }
  if (closed.empty()) return {};
  const double span = reach + apart;
  const std::vector<int> first = connected_sets(
      closed.size(), span * largest, [&](std::size_t i) { return groups_[closed[i]].centre; },
      [&](int i, int k) {
        const GroupOnFace &a = groups_[closed[i]], &b = groups_[closed[k]];
        return (a.centre - b.centre).norm() < span * std::max(a.larger, b.larger) && a.normal.dot(b.normal) > same_side;
      });
  std::vector<std::vector<int>> zones;
  std::vector<int> number(closed.size(), -1);
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (first[i] == static_cast<int>(i)) {
      number[i] = static_cast<int>(zones.size());
      zones.emplace_back();
    }
    zones[number[first[i]]].push_back(closed[i]);
  }
  return zones;
}

}  // namespace cgcontact
