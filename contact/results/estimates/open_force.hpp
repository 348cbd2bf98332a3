/// What part of a pair's force depends on how stiff the bodies are.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

struct OpenForce {
  bool given_by_loads = false;  ///< the pair's resultant follows from equilibrium
  /// Fraction of the pair's force: 1, or 0 where the loads give it, or what balances itself beside a resultant that
  /// they give, as around a shaft.
  double fraction = 0;
};

/// Returns whether a pair is tightened to its force, which then depends on no stiffness.
bool is_tightened(const SolvedState& state, std::size_t pair);

/// Returns one per pair; pairs without a closed point have none. figures: forces of the pairs.
std::vector<OpenForce> open_forces(const SolvedState& state, const std::vector<PairFigures>& figures);

}  // namespace cgcontact
