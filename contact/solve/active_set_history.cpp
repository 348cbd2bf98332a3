#include "contact/solve/active_set_history.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cgcontact {
namespace {

std::vector<std::vector<bool>> state_of(const std::vector<ContactPair>& pairs) {
  std::vector<std::vector<bool>> state;
  for (const ContactPair& pair : pairs) {
    state.emplace_back();
    for (std::size_t q = 0; q < pair.points.size(); ++q) state.back().push_back(pair.points.active(q));
  }
  return state;
}

}  // namespace

ActiveSetHistory::ActiveSetHistory(const std::vector<ContactPair>& pairs) : state_(state_of(pairs)), seen_{state_} {
  for (const ContactPair& pair : pairs) unrest_.emplace_back(pair.points.size(), 0);
}

long long ActiveSetHistory::record(const std::vector<ContactPair>& pairs) {
  const State before = std::move(state_);
  state_ = state_of(pairs);
  long long changed = 0;
  for (std::size_t k = 0; k < state_.size(); ++k)
    for (std::size_t q = 0; q < state_[k].size(); ++q) {
      const bool other = state_[k][q] != before[k][q];
      changed += other;
      unrest_[k][q] = std::max(0, unrest_[k][q] + (other ? 2 : -1));
    }
  if (changed > 0 && !seen_.insert(state_).second) ++repeats_;
  return changed;
}

std::string ActiveSetHistory::describe(const std::vector<ContactPair>& pairs) const {
  const auto keeps_changing = [](int unrest) { return unrest > 1; };
  std::vector<long long> count;
  for (const std::vector<int>& pair : unrest_) count.push_back(std::count_if(pair.begin(), pair.end(), keeps_changing));
  const std::size_t worst = std::max_element(count.begin(), count.end()) - count.begin();
  if (count[worst] == 0)
    return fmt::format("the active set cycles ({} repeated states); finer cells or another grid.offset may help",
                       repeats_);
  const ContactPair& pair = pairs[worst];
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (std::size_t q = 0; q < pair.points.size(); ++q) {
    if (!keeps_changing(unrest_[worst][q])) continue;
    low = low.cwiseMin(pair.points.x(q));
    high = high.cwiseMax(pair.points.x(q));
  }
  return fmt::format(
      "the active set cycles ({} repeated states): {} of {} points of contact \"{}\" between ({:.4g}, {:.4g}, {:.4g}) "
      "and ({:.4g}, {:.4g}, {:.4g}) m keep opening and closing; finer cells or another grid.offset may help",
      repeats_, count[worst], pair.points.size(), pair.spec->name, low[0], low[1], low[2], high[0], high[1], high[2]);
}

}  // namespace cgcontact
