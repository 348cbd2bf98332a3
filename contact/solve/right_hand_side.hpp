/// The right-hand side of one outer iteration: loads, lagged stresses, prescribed displacements and gaps.
#pragma once

#include "contact/solve/iterate.hpp"

namespace cgcontact {

class RightHandSide {
 public:
  explicit RightHandSide(const OuterProblem& problem);

  /// Nodal forces of the loads, system units; forgets what has been prescribed so far unless `keep_scale`.
  void begin(const std::vector<double>& load, bool keep_scale);
  /// What supports and contact add in the present state. Called by all ranks.
  void assemble(const Iterate& iterate);

  const RealView& vector() const { return vector_; }
  /// Scale of the linear tolerance: the norm of the real forces.
  double force_norm() const { return force_norm_; }

 private:
  void add_supports(const Iterate& iterate, std::vector<double>& stress_forces, std::vector<double>& values) const;
  double norm(const std::vector<double>& at_touched) const;

  RealView vector_;
  int place_of(int dof) const { return dof_of(place_[node_of_dof(dof)], component_of_dof(dof)); }

  std::vector<int> touched_;          ///< nodes on which supports or contact act
  std::vector<int> place_;            ///< of each node in touched_, or -1
  std::vector<double> touched_load_;  ///< the loads there
  double square_elsewhere_ = 0;       ///< of the loads on all others
  double force_norm_ = 0;
  double kappa_norm_ = 0;  ///< the largest so far
};

}  // namespace cgcontact
