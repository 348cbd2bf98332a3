/// Kernels of friction over contact groups. A group slides along two tangents, in plane strain along one; its rows of
/// the linear system are turned to the principal axes of TangentialContact::stiffness, so that each row has one
/// stiffness. One thread per group, as in group_kernels.hpp.
#pragma once

#include "contact/kernels/friction_law.hpp"
#include "contact/kernels/group_kernels.hpp"

namespace cgcontact {

/// A group's share of the rows of friction, by the axes that these have at present.
struct TangentFrame {
  double cosine = 1, sine = 0;  ///< of the angle from the first tangent to the first row

  /// Returns the direction of the first or the second row, by the tangents.
  KOKKOS_INLINE_FUNCTION double along(int row, int tangent) const {
    return row == tangent ? cosine : row == 0 ? sine : -sine;
  }
  /// Turns a vector by the tangents into its amount along a row.
  KOKKOS_INLINE_FUNCTION double by_row(int row, const double v[2]) const {
    return along(row, 0) * v[0] + along(row, 1) * v[1];
  }
};

/// Groups of all pairs with friction and their points, as in ContactGroupArrays; vectors by the points' tangents.
template <class Memory>
struct FrictionArrays {
  using Numbers = Kokkos::View<int*, Memory>;
  using Values = Kokkos::View<double*, Memory>;
  using Vectors = Kokkos::View<double* [2], Kokkos::LayoutRight, Memory>;
  using Flags = Kokkos::View<char*, Memory>;

  Numbers first_point;   ///< (groups + 1)
  Numbers normal_group;  ///< of each group: among all groups
  Numbers row;           ///< of each group: its first row among those of friction
  Numbers num_rows;      ///< of each group: 1 or 2
  Values coefficient;    ///< of each group
  Kokkos::View<TangentFrame*, Memory> frame;
  Kokkos::View<ZoneForce*, Memory> linear;  ///< of each row: its force and stiffness, linear about where they were made
  Values coupling;                          ///< of each row: its force per change of the gap, N/m
  Values gap;                               ///< of each group: change of its gap where `linear` was made, m
  Vectors mismatch;                         ///< of each group: N, the law's force less the linear one before
  Flags turned;                             ///< of each group: whether `frame` has changed with `linear`
  Values weight;                            ///< of each point, m^2
  Values pressure;                          ///< of each point, Pa: that of the last solution
  Values bound;                             ///< of each point, Pa
  Vectors lagged;                           ///< of each point: t*, in units of lagged_unit
  Vectors reference;                        ///< of each point: where it stuck last, m
  Values approach;                          ///< of each group: its gap when the load step began, m; 0: it was closed
  Vectors drift;                            ///< of each group: slip with which its gap closes, per gap
  double lagged_unit = 1;                   ///< Pa

  FrictionArrays() = default;
  FrictionArrays(std::size_t groups, std::size_t rows, std::size_t points)
      : first_point("cgcontact::friction::first_point", groups + 1),
        normal_group("cgcontact::friction::normal_group", groups),
        row("cgcontact::friction::row", groups),
        num_rows("cgcontact::friction::num_rows", groups),
        coefficient("cgcontact::friction::coefficient", groups),
        frame("cgcontact::friction::frame", groups),
        linear("cgcontact::friction::linear", rows),
        coupling("cgcontact::friction::coupling", rows),
        gap("cgcontact::friction::gap", groups),
        mismatch("cgcontact::friction::mismatch", groups),
        turned("cgcontact::friction::turned", groups),
        weight("cgcontact::friction::weight", points),
        pressure("cgcontact::friction::pressure", points),
        bound("cgcontact::friction::bound", points),
        lagged("cgcontact::friction::lagged", points),
        reference("cgcontact::friction::reference", points),
        approach("cgcontact::friction::approach", groups),
        drift("cgcontact::friction::drift", groups) {}
  int num_groups() const { return static_cast<int>(coefficient.extent(0)); }

  /// Turns amounts by rows into those by tangents.
  KOKKOS_INLINE_FUNCTION void by_tangents(int g, double first, double second, double out[2]) const {
    const TangentFrame f = frame(g);
    for (int i = 0; i < 2; ++i) out[i] = f.along(0, i) * first + f.along(1, i) * second;
  }
  /// Computes the slip of a group by tangents, m. change: of all rows of friction.
  template <class Change>
  KOKKOS_INLINE_FUNCTION void slip(int g, const Change& change, double out[2]) const {
    by_tangents(g, change(row(g)), num_rows(g) > 1 ? change(row(g) + 1) : 0, out);
  }
  /// Returns where a point of a group sticks, m: a pair open when a load step begins meets where the gap has closed.
  KOKKOS_INLINE_FUNCTION double held_at(int g, int q, int i) const {
    return reference(q, i) + approach(g) * drift(g, i);
  }
  /// Returns the linear force of a row whose group's gap has changed so, N. slip: of the row, m.
  KOKKOS_INLINE_FUNCTION double linear_force(int g, int r, double slip, double gap_change) const {
    return linear(r).at(slip) + coupling(r) * (gap_change - gap(g));
  }
  KOKKOS_INLINE_FUNCTION TangentialContact law(int g, int q, double k, const double slip[2]) const {
    const double l[2] = {lagged(q, 0) * lagged_unit, lagged(q, 1) * lagged_unit};
    const double held[2] = {held_at(g, q, 0), held_at(g, q, 1)};
    return {k, l, slip, held};
  }
};

/// Takes the pressure of each point. change: of the mean gap of all groups, m.
template <class Exec, class Memory>
void take_pressures(const Exec& exec, const ContactGroupArrays<Memory>& groups, const FrictionArrays<Memory>& friction,
                    const Kokkos::View<double*, Memory>& change) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::pressures", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int g = friction.normal_group(f);
        const double gap = groups.initial_gap(g) + change(g);
        for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) {
          const int point = groups.first_point(g) + q - friction.first_point(f);
          const double p = groups.closed_pressure(g, point, gap);
          friction.pressure(q) = groups.active(point) && p > 0 ? p : 0;
        }
      });
}

/// Gaps of the groups when a load step begins. change: of all groups, m.
template <class Exec, class Memory>
void take_gaps(const Exec& exec, const ContactGroupArrays<Memory>& groups, const FrictionArrays<Memory>& friction,
               const Kokkos::View<double*, Memory>& change) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::gaps", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int g = friction.normal_group(f);
        const double gap = groups.initial_gap(g) + change(g);
        bool closed = false;
        for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) closed |= friction.bound(q) > 0;
        friction.approach(f) = gap > 0 && !closed ? gap : 0;
      });
}

/// Adds a factor times the gaps and slips of the groups at which lagged stress leaves closed points no force, mean p*/k
/// and t*/k, m. gaps: of all groups; slips: of the rows of friction.
template <class Exec, class Memory, class Rows>
void add_forceless_gaps(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                        const FrictionArrays<Memory>& friction, double factor, const Rows& gaps, const Rows& slips) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::forceless_gaps", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int g = friction.normal_group(f), first = groups.first_point(g) - friction.first_point(f);
        double area = 0, pressure = 0, shear[2] = {0, 0};
        for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) {
          const double w = friction.weight(q);
          area += w;
          pressure += w * groups.lagged(first + q) * groups.lagged_unit;
          for (int i = 0; i < 2; ++i) shear[i] += w * friction.lagged(q, i) * friction.lagged_unit;
        }
        const double k = groups.law(g).k * area;
        gaps(g) += factor * pressure / k;
        for (int i = 0; i < friction.num_rows(f); ++i)
          slips(friction.row(f) + i) += factor * friction.frame(f).by_row(i, shear) / k;
      });
}

/// Bound of points that do not slip yet, Pa.
constexpr double any_shear = 1e300;

/// Largest shear of closed points.
enum class ShearBound { none, by_pressure, any };

/// Sets the largest shear of the points: with by_pressure mu times their pressure; of open ones nothing.
template <class Exec, class Memory>
void set_bounds(const Exec& exec, const ContactGroupArrays<Memory>& groups, const FrictionArrays<Memory>& friction,
                ShearBound of_closed) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::bounds", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int first = groups.first_point(friction.normal_group(f));
        for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) {
          const int point = first + q - friction.first_point(f);
          const double by_pressure = friction.coefficient(f) * friction.pressure(q);
          const double most = of_closed == ShearBound::by_pressure ? by_pressure : any_shear;
          friction.bound(q) = groups.active(point) && of_closed != ShearBound::none ? most : 0;
        }
      });
}

/// Force of a group whose points follow the law, by tangents.
struct GroupFriction {
  double force[2] = {0, 0};         ///< N
  double stiffness[3] = {0, 0, 0};  ///< -d force / d slip, N/m: 00, 01, 11
  double coupling[2] = {0, 0};      ///< d force / d gap, N/m: what slips carries mu p
};

/// Computes the force at a slip and a change of the gap, m. Points that are open or without pressure where bounds were
/// set carry nothing.
template <class Memory>
KOKKOS_INLINE_FUNCTION GroupFriction force_of_law(const ContactGroupArrays<Memory>& groups,
                                                  const FrictionArrays<Memory>& friction, int f, double gap_change,
                                                  const double slip[2]) {
  const int g = friction.normal_group(f), first = groups.first_point(g) - friction.first_point(f);
  const double k = groups.law(g).k, gap = groups.initial_gap(g) + gap_change;
  GroupFriction sum;
  for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) {
    if (friction.bound(q) == 0) continue;
    const TangentialContact law = friction.law(f, q, k, slip);
    double bound = any_shear;
    if (friction.bound(q) < any_shear) {
      const double p = groups.closed_pressure(g, first + q, gap);
      if (!(p > 0)) continue;
      bound = friction.coefficient(f) * p;
    }
    const double w = friction.weight(q), fraction = law.carried_fraction(bound);
    for (int i = 0; i < 2; ++i) {
      sum.force[i] += w * fraction * law.z[i];
      if (!law.sticks(bound)) sum.coupling[i] -= w * friction.coefficient(f) * k * law.z[i] / law.size();
    }
    sum.stiffness[0] += w * law.stiffness(bound, held_in_slip, 0, 0);
    sum.stiffness[1] += w * law.stiffness(bound, held_in_slip, 0, 1);
    sum.stiffness[2] += w * law.stiffness(bound, held_in_slip, 1, 1);
  }
  return sum;
}

/// Makes the force of every row linear about the present slip and gap; turns the rows of groups whose principal axes
/// have changed. change: of all rows, m; slips: those of friction among them. Sets `mismatch`, `linear`, `coupling`,
/// `gap`, `frame`, `turned`.
template <class Exec, class Memory, class Change>
void linearise_friction(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                        const FrictionArrays<Memory>& friction, const Change& change, const Change& slips) {
  static_assert(reaches<Exec, Memory>);
  constexpr double same_axes = 0.02;  // of the trace: what is left off the diagonal resists slip by the square of it
  Kokkos::parallel_for(
      "cgcontact::friction::linearise", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int row = friction.row(f), rows = friction.num_rows(f);
        const double gap = change(friction.normal_group(f));
        double slip[2], before[2];
        friction.slip(f, slips, slip);
        friction.by_tangents(f, friction.linear_force(f, row, slips(row), gap),
                             rows > 1 ? friction.linear_force(f, row + 1, slips(row + 1), gap) : 0, before);
        const GroupFriction now = force_of_law(groups, friction, f, gap, slip);
        const auto& s = now.stiffness;
        friction.gap(f) = gap;
        for (int i = 0; i < 2; ++i) friction.mismatch(f, i) = rows > i ? now.force[i] - before[i] : 0;
        TangentFrame frame = friction.frame(f);
        const double off =
            frame.cosine * frame.sine * (s[2] - s[0]) + (frame.cosine * frame.cosine - frame.sine * frame.sine) * s[1];
        friction.turned(f) = rows > 1 && (off < 0 ? -off : off) > same_axes * (s[0] + s[2]);
        if (friction.turned(f)) {
          const double angle = 0.5 * std::atan2(2 * s[1], s[0] - s[2]);
          frame.cosine = std::cos(angle);
          frame.sine = std::sin(angle);
          friction.frame(f) = frame;
        }
        for (int i = 0; i < rows; ++i) {
          const double c = frame.along(i, 0), d = frame.along(i, 1);
          friction.linear(row + i) = {frame.by_row(i, now.force), c * c * s[0] + 2 * c * d * s[1] + d * d * s[2],
                                      frame.by_row(i, slip)};
          friction.coupling(row + i) = frame.by_row(i, now.coupling);
        }
      });
}

/// Computes the force of every row, N, by the law at start + t step less the linear one: excess_forces() of friction.
/// start, step: of all rows, m; slip_start, slip_step, excess: those of friction among them.
template <class Exec, class Memory, class Rows>
void friction_excess(const Exec& exec, const ContactGroupArrays<Memory>& groups, const FrictionArrays<Memory>& friction,
                     const Rows& start, const Rows& step, const Rows& slip_start, const Rows& slip_step, double t,
                     const Rows& excess) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::excess", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const int row = friction.row(f), rows = friction.num_rows(f), g = friction.normal_group(f);
        const double gap = start(g) + t * step(g);
        const double now[2] = {slip_start(row) + t * slip_step(row),
                               rows > 1 ? slip_start(row + 1) + t * slip_step(row + 1) : 0};
        double slip[2];
        friction.by_tangents(f, now[0], now[1], slip);
        const GroupFriction law = force_of_law(groups, friction, f, gap, slip);
        for (int i = 0; i < rows; ++i)
          excess(row + i) = friction.frame(f).by_row(i, law.force) - friction.linear_force(f, row + i, now[i], gap);
      });
}

/// Adds what changes of the gaps add to the linear forces of the rows of friction, in terms of `unit` (N). change: of
/// all rows, m; force: of the rows of friction.
template <class Exec, class Memory, class Rows>
void add_coupled_forces(const Exec& exec, const FrictionArrays<Memory>& friction, const Rows& change, double unit,
                        const Rows& force) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::coupled_forces", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const double moved = change(friction.normal_group(f)) - friction.gap(f);
        for (int r = friction.row(f); r < friction.row(f) + friction.num_rows(f); ++r)
          force(r) += friction.coupling(r) * moved / unit;
      });
}

/// State of the points of friction, each by tangents.
template <class Memory>
struct FrictionState {
  typename FrictionArrays<Memory>::Vectors shear;      ///< Pa, on the second body
  typename FrictionArrays<Memory>::Vectors slip;       ///< m, of this load step, also of open points
  typename FrictionArrays<Memory>::Vectors reference;  ///< m, where a point sticks if that is the end of the step
  typename FrictionArrays<Memory>::Flags slips;
};

/// Updates the state at the present slip of the groups. An open point sticks where it is.
template <class Exec, class Memory, class Change>
void friction_state(const Exec& exec, const ContactGroupArrays<Memory>& groups, const FrictionArrays<Memory>& friction,
                    const Change& change, const FrictionState<Memory>& state) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::friction::state", Kokkos::RangePolicy<Exec>(exec, 0, friction.num_groups()),
      KOKKOS_LAMBDA(const int f) {
        const double k = groups.law(friction.normal_group(f)).k;
        double slip[2];
        friction.slip(f, change, slip);
        for (int q = friction.first_point(f); q < friction.first_point(f + 1); ++q) {
          const double bound = friction.bound(q);
          const TangentialContact law = friction.law(f, q, k, slip);
          const bool slips = bound > 0 && !law.sticks(bound);
          state.slips(q) = slips;
          for (int i = 0; i < 2; ++i) {
            const double shear = bound > 0 ? law.carried_fraction(bound) * law.z[i] : 0,
                         held = friction.held_at(f, q, i);
            state.shear(q, i) = shear;
            const double elastic = slips ? (friction.lagged(q, i) * friction.lagged_unit - shear) / k : 0;
            state.slip(q, i) = slips || bound == 0 ? slip[i] - elastic - held : 0;
            state.reference(q, i) = held + state.slip(q, i);
          }
        }
      });
}

}  // namespace cgcontact
