/// The recovered stress at supports and contact, which the outer iteration lags.
#pragma once

#include "contact/solve/boundary_stress.hpp"
#include "contact/solve/iterate.hpp"

namespace cgcontact {

class LaggedStress {
 public:
  explicit LaggedStress(const OuterProblem& problem);

  /// Updates sigma* by the displacements at supports and contact; returns the relative change (area-weighted, L2).
  double update(Iterate& iterate);

 private:
  std::vector<BoundaryStress> stress_;  ///< of each body
};

}  // namespace cgcontact
