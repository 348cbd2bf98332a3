/// Values that the ranks compute together.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"

namespace cgcontact {

/// Computes values[i] = value_at(i), on all threads in chunks of `grain`; each rank computes its range, then all have
/// all. Collective.
template <class ValueAt>
void compute_together(const char* label, std::size_t grain, std::vector<double>& values, const ValueAt& value_at) {
  const std::size_t begin = share_out(values.size()).first, end = share_out(values.size()).second;
  parallel_for(label, end - begin, grain, [&](std::size_t i) { values[begin + i] = value_at(begin + i); });
  put_together(values);
}

}  // namespace cgcontact
