/// Springs of the scene beside contact: what they take of a load, the contact does not get.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

struct SpringShare {
  int body = 0;
  double share = 0;                ///< of what resists the push on the body, 0 to 1
  double force = 0;                ///< N, of the springs; of a slice in plane strain on a quadtree
  std::vector<std::string> faces;  ///< "body.face" that the springs are on
};

/// Returns bodies whose springs take more than ResultOptions::largest_imbalance of a push beside contact. A body that
/// contact presses against its springs (an elastic foundation) is not one. Needs the figures of pairs and supports and
/// the balance.
std::vector<SpringShare> spring_shares(const SolvedState& state, const Results& results);

/// Writes the largest share to the verdict, unless the run did not converge, and others as warnings. From
/// ResultOptions::largest_hold on the verdict cannot be good.
void report_spring_shares(const SolvedState& state, Results& results);

}  // namespace cgcontact
