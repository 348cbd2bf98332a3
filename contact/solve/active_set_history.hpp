/// History of the active set during an outer iteration: size of changes, states that come back, positions.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

class ActiveSetHistory {
 public:
  /// Begins with the present state of the pairs.
  explicit ActiveSetHistory(const std::vector<ContactPair>& pairs);
  /// Takes note of the state after an iteration; returns how many points have another one than before it.
  long long record(const std::vector<ContactPair>& pairs);
  /// Iterations that changed the active set to one that it was before. An iteration that converges has none or one by
  /// chance.
  bool cycles() const { return repeats_ > 2; }
  /// Describes the pair most of whose points kept changing in the last iterations, how many and where (m).
  std::string describe(const std::vector<ContactPair>& pairs) const;

 private:
  using State = std::vector<std::vector<bool>>;  // per pair and point
  State state_;
  std::vector<std::vector<int>> unrest_;  // two more with each change of a point, one less in an iteration without
  std::set<State> seen_;
  int repeats_ = 0;
};

}  // namespace cgcontact
