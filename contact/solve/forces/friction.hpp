/// Friction in the outer iteration: Coulomb's law with the recovered shear lagged, like the pressure. Each iteration
/// takes one Newton step of normal and shear together, whose matrix is not symmetric where points slip: mu p follows
/// the gap (docs/theory.md). In the first solve of a load step all closed points stick, from where they stuck at the
/// end of the last one; or none of them, if that solve has shown that they slide.
#pragma once

#include <Kokkos_DualView.hpp>

#include "contact/kernels/friction_kernels.hpp"
#include "contact/solve/forces/outer_problem.hpp"
#include "core/geometry/symmetry_plane.hpp"

namespace cgcontact {

/// Law of a group's points on the host, with the bounds of the present gap.
struct FrictionGroup {
  struct Point {
    double weight, bound;       ///< m^2, Pa
    double lagged[2], held[2];  ///< by tangents, Pa, m
  };
  std::size_t pair, group;   ///< group: of the pair
  double k;                  ///< Pa/m
  double slip[2];            ///< by tangents, m
  double force[2], fall[3];  ///< of the linear force at that slip and the present gap: N; 00, 01, 11 per slip, N/m
  std::vector<Point> points;
};

class Friction {
 public:
  explicit Friction(const OuterProblem& problem);

  bool any() const { return arrays_.num_groups() > 0; }
  /// Returns the first row of friction, which come after those of all contact groups.
  int first_row() const { return first_row_; }
  int num_rows() const { return static_cast<int>(arrays_.linear.extent(0)); }
  const FrictionArrays<MemSpace>& arrays() const { return arrays_; }

  /// Resets slip and shear to zero.
  void forget();
  /// Makes closed points stick, until slide() or release(). change: as below, from which gaps close in this step.
  void begin_step(const ContactGroupArrays<MemSpace>& groups, const RealView& change);
  /// Returns whether the shear of the groups of some pair adds up to more than mu times their pressing forces. force:
  /// of all rows.
  bool carries_less_than(const std::vector<double>& force) const;
  /// Lets closed points slide without friction, until release().
  void slide() { bound_ = ShearBound::none; }
  bool is_released() const { return bound_ == ShearBound::by_pressure; }
  void release() { bound_ = ShearBound::by_pressure; }

  /// Adds a factor times the gaps and slips, of all rows, m, at which the present lagged stress leaves no force.
  void add_forceless_gaps(const ContactGroupArrays<MemSpace>& groups, double factor, const RealView& change) const;
  /// Renews pressures, bounds, and forces that are linear about the present slip. change: of the gaps of all rows, m.
  /// True: rows of the system have turned.
  bool renew(const ContactGroupArrays<MemSpace>& groups, const RealView& change);
  /// Returns the distance of the forces at the last renewal from those of the law, relative to the pressure; 1 while
  /// points are not released. RMS over the area.
  double residual() const { return is_released() ? residual_ : 1; }
  /// Returns, for pairs all of whose closed points slip while the loads exceed what friction carries
  /// (use_of_friction()) by the same from iteration to iteration, that excess relative to it. 0: the pair holds.
  const std::vector<double>& sliding() const { return sliding_; }

  /// Adds rows of friction to excess_forces(): by the law at start + t along, less the linear forces. All: of all rows,
  /// m, N.
  void add_excess(const ContactGroupArrays<MemSpace>& groups, const RealView& start, const RealView& along, double t,
                  const RealView& excess) const;
  /// Adds what gaps change of the linear forces, to forces of all rows in terms of `unit` (N).
  void add_coupled_forces(const RealView& change, double unit, const RealView& forces) const;
  /// Returns - d force / d gap of all rows, N/m (positive resists, as a stiffness); empty without friction.
  std::vector<double> coupling() const;
  /// Returns the law of all groups. change: as above.
  std::vector<FrictionGroup> laws(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const;
  /// Puts in the linear forces as those of groups that have no points, behind all others.
  void put_into(const ContactGroupArrays<MemSpace>& groups) const;

  /// Ends the load step: points stick where they are now. change: as above.
  void end_step(const ContactGroupArrays<MemSpace>& groups, const RealView& change);
  /// Returns the state of every pair, as after the next end_step().
  std::vector<FrictionPoints> state(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const;

  /// t* of the points of all pairs with friction, in turn, in Scales::stress: two components, by tangents.
  using Stress = Kokkos::DualView<double* [2], Kokkos::LayoutRight, ExecSpace>;
  Stress stress;

 private:
  struct Now;
  Now now(const ContactGroupArrays<MemSpace>& groups, const RealView& change) const;
  void turn_rows();
  void take_drifts(const ContactGroupArrays<MemSpace>& groups) const;
  void look_for_sliding(const ContactGroupArrays<MemSpace>& groups, const RealView& change);
  std::vector<FrictionPoints> with_step(const Now& state) const;
  RealView of_friction(const RealView& all) const;

  OuterProblem problem_;
  FrictionArrays<MemSpace> arrays_;
  std::vector<TangentFrame> frames_;                ///< those that the rows of the system have
  std::vector<std::vector<SymmetryPlane>> planes_;  ///< of symmetry, of each pair
  int first_row_ = 0;
  ShearBound bound_ = ShearBound::any;
  bool new_step_ = true;  ///< a step may be solved several times, under several preloads
  double residual_ = 1;
  std::vector<double> sliding_, asked_;  ///< of each pair
  std::vector<FrictionPoints> history_;  ///< of each pair, with the steps that have ended
};

}  // namespace cgcontact
