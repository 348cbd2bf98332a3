/// The contact groups of a pair with what its points say about them, and which of the closed ones are one zone.
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Contact group, m, N.
struct GroupOnFace {
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double area = 0, force = 0, gap_change = 0;  ///< gap_change: by which the deformation opens the mean gap
  double larger = 0;                           ///< the larger cells of both bodies
  bool closed() const { return force > 0; }
};

class PairGroups {
 public:
  /// group_force: of the pair's groups, OuterResult::group_force.
  PairGroups(const SolvedState& state, int pair, const double* group_force);
  const std::vector<GroupOnFace>& groups() const { return groups_; }
  const ContactPair& pair() const { return pair_; }
  /// Returns the closed groups of each zone: those nearer to each other than what a problem looks at (`reach`, cells).
  std::vector<std::vector<int>> zones(double reach) const;

 private:
  const ContactPair& pair_;
  std::vector<GroupOnFace> groups_;
};

}  // namespace cgcontact
