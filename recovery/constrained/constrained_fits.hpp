/// All patches of a list, fitted and constrained: by degree and number of bodies, each step one loop over all patches
/// of a class.
#pragma once

#include "recovery/constrained/patch_lists.hpp"
#include "recovery/constrained/patch_rows.hpp"
#include "recovery/constrained/patch_states.hpp"

namespace cgcontact {

/// Output arrays for the results of a body's patches.
struct PatchResults {
  const RecoveredField& field;
  PatchStates& states;
  EdgeTerms& edges;
  QuadraticTerms& quadratic;
  long long truncated_rows = 0, lowered = 0;  ///< lowered: patches of degree 1 where 2 was asked for
};

/// Fits the patches of the lists, where their kinds and statuses are set. Returns the nodes whose cells do not carry
/// the quadratic polynomial that was asked for, ascending: nothing is stored for these.
std::vector<int> fit_constrained(const PatchContext& context, const PatchRows& rows, PatchLists& lists,
                                 PatchResults& results);

}  // namespace cgcontact
