/// Choice of the solve that has the results of a run to an accuracy.
#pragma once

#include "core/results/results.hpp"

namespace cgcontact {

/// Returns its number, from 0: the one that the run has chosen; else the last solve that converged, or the last one if
/// none did.
inline std::size_t answer_of(const AccuracyFigures& accuracy) {
  if (accuracy.answer >= 0) return static_cast<std::size_t>(accuracy.answer);
  for (std::size_t k = accuracy.solves.size(); k-- > 0;)
    if (accuracy.solves[k].converged) return k;
  return accuracy.solves.empty() ? 0 : accuracy.solves.size() - 1;
}

}  // namespace cgcontact
