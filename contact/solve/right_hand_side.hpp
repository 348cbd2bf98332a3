/// The right-hand side of one outer iteration: loads, lagged stresses, prescribed displacements and gaps.
#pragma once

#include "contact/solve/iterate.hpp"

namespace cgcontact {

class RightHandSide {
 public:
  explicit RightHandSide(int num_dofs) : vector_("cgcontact::right_hand_side", num_dofs) {}

  void assemble(const Iterate& iterate);
  /// No displacement has been prescribed so far.
  void forget() { kappa_norm_ = 0; }

  const RealView& vector() const { return vector_; }
  /// Scale of the linear tolerance: the norm of the real forces.
  double force_norm() const { return force_norm_; }

 private:
  RealView vector_;
  double force_norm_ = 0;
  double kappa_norm_ = 0;  ///< the largest so far
};

}  // namespace cgcontact
