/// Right-hand side of one outer iteration: loads, lagged stresses, prescribed displacements and gaps.
#pragma once

#include "contact/solve/iterate.hpp"

namespace cgcontact {

class RightHandSide {
 public:
  explicit RightHandSide(const OuterProblem& problem);

  /// Begins with the nodal forces of the loads, system units; forgets what has been prescribed so far unless
  /// `keep_scale`.
  void begin(const std::vector<double>& load, bool keep_scale);
  /// Takes the rows of the system once they have been turned.
  void take_rows(const OuterProblem& problem);
  /// Assembles the terms of supports and contact in the present state.
  void assemble(const Iterate& iterate);

  /// Assembles forces of the groups (system units) alone, for which the loads are lost; returns their norm.
  double assemble_groups(const std::vector<double>& forces);

  const RealView& vector() const { return vector_; }
  /// Returns the scale of the linear tolerance: the norm of the real forces.
  double force_norm() const { return force_norm_; }
  /// Returns whether all of it is so small that squares underflow, but not zero.
  bool underflows() const;

 private:
  double norm() const;

  ExecSpace exec_;
  RealView vector_;
  TouchedNodes<MemSpace> touched_;  ///< nodes on which supports or contact act
  RealView touched_load_, force_;   ///< the loads there, and all forces
  double square_elsewhere_ = 0;     ///< of the loads on all others
  double force_norm_ = 0;
  double kappa_norm_ = 0;  ///< the largest so far
};

}  // namespace cgcontact
