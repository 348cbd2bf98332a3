/// State of the outer iteration: displacements, rigid motions and lagged stresses, and the gaps and forces that follow
/// from them.
#pragma once

#include <Kokkos_DualView.hpp>

#include "contact/solve/floating/body_motion.hpp"
#include "contact/solve/floating/rigid_contact.hpp"
#include "contact/solve/forces/contact_arrays.hpp"
#include "contact/solve/forces/friction.hpp"

namespace cgcontact {

/// Fraction of the kappa terms below which forces and pressures are rounding.
constexpr double no_force = 1e-10;

/// Values of points that the host sets (h_view, then modify_host()) and kernels read.
using PointStresses = Kokkos::DualView<double*, ExecSpace>;

std::vector<double> to_host(const RealView& values);

struct Iterate {
  explicit Iterate(const OuterProblem& outer_problem);
  Iterate(const Iterate&) = delete;

  /// Resets displacement and stress to zero.
  void forget();
  /// Displacements and stresses of the same bodies and pairs, to which supports have been added.
  void warm_start_from(const Iterate& other);
  /// Moves rigid motions from u into body_motions, with what follows for the gaps.
  void set_rigid_motions_aside();

  /// Returns the unit of forces, N.
  double force_unit() const { return problem.scales.stress * problem.scales.length * problem.scales.length; }

  /// Return the arrays that kernels run on, as the host has left them.
  const ContactGroupArrays<MemSpace>& groups() const;
  const SupportArrays<MemSpace>& supports() const;

  /// Return displacements along the direction of each support, m: of the rigid motions, and of all.
  RealView rigid_displacements() const;
  RealView support_displacements() const;
  /// Returns sigma* - kappa E/h (u . d - value) of every support point, Pa.
  std::vector<double> support_tractions() const;

  /// Return the change of the mean gap of all contact groups, and after them slip of the rows of friction, m; without
  /// the rigid motions, of any displacements (Scales::length).
  RealView gap_change() const;
  RealView gap_change_of(const RealView& displacements) const;
  std::vector<double> group_gap_change() const { return to_host(gap_change()); }
  /// Return the force of each group, system units, sum over its closed points of w (p* - kappa E/h gap): with the gap
  /// of the current displacement, or without that of the deformation (the right-hand side).
  RealView group_forces(bool with_displacement) const;
  std::vector<double> group_force(bool with_displacement) const { return to_host(group_forces(with_displacement)); }
  /// Returns the present stiffness of each group, system units.
  std::vector<double> group_stiffness() const;
  /// Returns what resists per gap of the coupled row, system units, or nothing.
  std::vector<double> group_coupling() const;
  /// Closes the points of every pair that press, but where all of a pair is below `fraction` of its k: bonded pairs
  /// stay closed.
  void close_pressing_points(double fraction);
  /// Returns the sum of the magnitudes of the forces of all contact groups, N.
  double total_force() const;

  /// Returns the sum of the magnitudes of the forces in springs that follow a motion, N.
  double spring_force() const;
  /// Moves their rest positions to where the motions are, or to where the steps of the last iterations tend to, body by
  /// body: each has a pace of its own.
  void update_spring_anchors();

  OuterProblem problem;
  RealView u;  ///< without the rigid motions, Scales::length
  BodyMotions body_motions;
  FloatingBodies floating;
  SmallZones small_zones;
  Friction friction;
  PointStresses support_stress;  ///< of each support point, Scales::stress
  PointStresses contact_stress;  ///< p* of the points of all pairs, in turn, Scales::stress
  RealView rigid_gap_change;     ///< of each contact group, m

 private:
  static double whole_length_of(const std::vector<double>& step, std::vector<double>& last);

  ContactGroupArrays<MemSpace> groups_;
  SupportArrays<MemSpace> supports_;
  DirectionArrays<MemSpace> support_directions_, row_directions_;
  IntView entry_index_;                                 ///< of the entries of rows in row_directions_
  std::vector<std::vector<double>> last_spring_steps_;  ///< m, of each body's springs
};

}  // namespace cgcontact
