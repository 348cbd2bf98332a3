/// Active set: the contact points that are closed.
#pragma once

#include <string>

#include "contact/solve/iterate.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {

/// Closes points at the start: where bodies meet that loads alone press together; else as few points as hold them
/// against the loads.
void initialise_active_set(Iterate& iterate);

/// Activates points where p* - kappa E/h gap > 0 (p* of the previous iterate). Where all of a pair is rounding of kappa
/// E/h times the displacements (bodies that touch without force) nothing changes.
void close_pressing_points(Iterate& iterate);

/// Updates that, and the zones smaller than the cells. decide: also which groups lie in them.
void update_active_set(Iterate& iterate, bool decide);

/// Opens the pairs that separate as the loads move the bodies that contact does not balance; returns their names.
std::vector<std::string> open_separating_pairs(Iterate& iterate, const FreeMotions& unbalanced);

long long count_active(const std::vector<ContactPair>& pairs);

/// Motions that supports and closed points resist by less than `no_stiffness` of the rest, and that the loads drive.
FreeMotions driven_motions(const OuterProblem& problem, double no_stiffness = rounding);

}  // namespace cgcontact
