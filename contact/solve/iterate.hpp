/// One state of the outer iteration: displacements, rigid parts and lagged stresses, and the gaps and forces that
/// follow from them.
#pragma once

#include "contact/solve/outer_problem.hpp"
#include "contact/solve/rigid_contact.hpp"
#include "contact/solve/rigid_part.hpp"
#include "contact/solve/small_zones.hpp"

namespace cgcontact {

struct Iterate {
  explicit Iterate(const OuterProblem& outer_problem);
  Iterate(const Iterate&) = delete;

  /// Back to no displacement and no stress.
  void forget();
  /// Displacements and stresses of the same bodies and pairs, to which supports have been added.
  void take_over(const Iterate& other);
  /// From u into rigid_parts, and what follows for the gaps.
  void set_rigid_parts_aside();

  /// Of a support, Pa/m.
  double support_stiffness(const SupportPoint& p) const;
  /// Weight (m^2) and stiffness (Pa/m) -> system units.
  double to_stiffness(double pa_per_m, double area) const {
    return pa_per_m * area / (problem.scales.stress * problem.scales.length);
  }
  /// Unit of forces, N.
  double force_unit() const { return problem.scales.stress * problem.scales.length * problem.scales.length; }

  /// Along the support's direction, m; of its body's rigid part, and of all (`host_u`: u on the host).
  double rigid_displacement(const SupportPoint& p) const;
  double displacement_of(const SupportPoint& p, const RealView::HostMirror& host_u) const;

  /// sigma* - kappa E/h (u . d - value) of every support point, Pa.
  std::vector<double> support_tractions() const;

  /// Change of the mean gap of every group, m.
  std::vector<double> group_gap_change() const;
  /// Force of each group, system units, sum over its closed points of w (p* - kappa E/h gap): with the gap of the
  /// current displacement, or without that of the deformation (the right-hand side).
  std::vector<double> group_force(bool with_displacement) const;
  /// Present stiffness of each group, system units.
  std::vector<double> group_stiffness() const;
  /// Of all contact groups, N.
  double total_force() const;

  /// Sum of the magnitudes of the forces in springs that follow a motion, N.
  double spring_force() const;
  /// Moves their rest positions to where the motions are, or to where the steps of the last iterations tend to, body by
  /// body: each has a pace of its own.
  void let_springs_follow();

  OuterProblem problem;
  RealView u;  ///< without the rigid parts, Scales::length
  RigidParts rigid_parts;
  FloatingBodies floating;
  SmallZones small_zones;
  std::vector<double> support_stress;               ///< of each support point, Scales::stress
  std::vector<std::vector<double>> contact_stress;  ///< p* of each pair and point, Scales::stress
  std::vector<double> rigid_gap_change;             ///< of each contact group, m

 private:
  static double whole_length_of(const std::vector<double>& step, std::vector<double>& last);

  std::vector<std::vector<double>> last_spring_steps_;  ///< m, of each body's springs
};

RealView::HostMirror host_copy(const RealView& u);

}  // namespace cgcontact
