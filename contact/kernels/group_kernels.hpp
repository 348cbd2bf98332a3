/// Kernels over contact groups: gaps, forces, stiffness, which points are closed. One thread per group goes over its
/// points in their order, so that results are bitwise the same on any number of threads. All views are in memory that
/// `exec` reaches; m, Pa, N unless a view says otherwise.
#pragma once

#include <cmath>

#include "contact/kernels/contact_law.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Force of a group in a zone smaller than the cells, by its mean gap g alone, F = force - stiffness (g - gap): N, N/m,
/// m.
struct ZoneForce {
  double force = 0, stiffness = 0, gap = 0;

  KOKKOS_INLINE_FUNCTION double at(double g) const { return force - stiffness * (g - gap); }
};

/// Groups of all pairs, in turn, and their points.
template <class Memory>
struct ContactGroupArrays {
  using Values = Kokkos::View<double*, Memory>;
  using Flags = Kokkos::View<char*, Memory>;

  Kokkos::View<int*, Memory> first_point;  ///< (groups + 1)
  Kokkos::View<NormalContact*, Memory> law;
  Values initial_gap;  ///< m
  Flags in_zone;       ///< presses by `zone` instead of its points
  Kokkos::View<ZoneForce*, Memory> zone;
  Values weight, lagged;   ///< of each point: m^2; p*, in units of lagged_unit
  Flags active;            ///< of each point
  double lagged_unit = 1;  ///< Pa

  ContactGroupArrays() = default;
  ContactGroupArrays(std::size_t groups, std::size_t points)
      : first_point("cgcontact::contact::first_point", groups + 1),
        law("cgcontact::contact::law", groups),
        initial_gap("cgcontact::contact::initial_gap", groups),
        in_zone("cgcontact::contact::in_zone", groups),
        zone("cgcontact::contact::zone", groups),
        weight("cgcontact::contact::weight", points),
        lagged("cgcontact::contact::lagged", points),
        active("cgcontact::contact::active", points) {}
  KOKKOS_INLINE_FUNCTION double closed_pressure(int group, int point, double gap) const {
    return law(group).closed_pressure(lagged(point) * lagged_unit, gap);
  }
  int num_groups() const { return static_cast<int>(law.extent(0)); }
};

template <class Exec, class Memory>
constexpr bool reaches = Kokkos::SpaceAccessibility<Exec, Memory>::accessible;

/// Computes y(g) = start(g) + factor * sum over row g of value x(column).
template <class Exec, class Numbers, class Rows, class X, class Values>
void multiply_rows(const Exec& exec, const Numbers& begin, const Numbers& column, const Rows& value, const X& x,
                   double factor, const Values& start, const Values& y) {
  static_assert(reaches<Exec, typename Values::memory_space> && reaches<Exec, typename X::memory_space>);
  Kokkos::parallel_for(
      "cgcontact::contact::rows", Kokkos::RangePolicy<Exec>(exec, 0, static_cast<int>(y.extent(0))),
      KOKKOS_LAMBDA(const int g) {
        double sum = 0;
        for (int e = begin(g); e < begin(g + 1); ++e) sum += value(e) * x(column(e));
        y(g) = start(g) + factor * sum;
      });
}

/// Computes the force of each group in terms of `unit` (N): sum over its closed points of w (p* - k gap). change: of
/// the mean gap, m.
template <class Exec, class Memory>
void group_forces(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                  const Kokkos::View<double*, Memory>& change, double unit,
                  const Kokkos::View<double*, Memory>& force) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::group_forces", Kokkos::RangePolicy<Exec>(exec, 0, groups.num_groups()),
      KOKKOS_LAMBDA(const int g) {
        const double gap = groups.initial_gap(g) + change(g);
        double sum = 0;
        for (int q = groups.first_point(g); q < groups.first_point(g + 1); ++q)
          if (groups.active(q)) sum += groups.weight(q) * groups.closed_pressure(g, q, gap);
        force(g) = (groups.in_zone(g) ? groups.zone(g).at(gap) : sum) / unit;
      });
}

/// Stiffness of each group in terms of `unit` (N/m): k times the area of its closed points.
template <class Exec, class Memory>
void closed_stiffness(const Exec& exec, const ContactGroupArrays<Memory>& groups, double unit,
                      const Kokkos::View<double*, Memory>& stiffness) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::group_stiffness", Kokkos::RangePolicy<Exec>(exec, 0, groups.num_groups()),
      KOKKOS_LAMBDA(const int g) {
        double area = 0;
        for (int q = groups.first_point(g); q < groups.first_point(g + 1); ++q)
          if (groups.active(q)) area += groups.weight(q);
        stiffness(g) = (groups.in_zone(g) ? groups.zone(g).stiffness : groups.law(g).k * area) / unit;
      });
}

/// Finds the largest magnitude of p* - k gap of the points of each group, Pa.
template <class Exec, class Memory>
void largest_pressures(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                       const Kokkos::View<double*, Memory>& change, const Kokkos::View<double*, Memory>& largest) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::largest_pressures", Kokkos::RangePolicy<Exec>(exec, 0, groups.num_groups()),
      KOKKOS_LAMBDA(const int g) {
        const double gap = groups.initial_gap(g) + change(g);
        double most = 0;
        for (int q = groups.first_point(g); q < groups.first_point(g + 1); ++q) {
          const double p = groups.closed_pressure(g, q, gap), magnitude = p < 0 ? -p : p;
          most = magnitude > most ? magnitude : most;
        }
        largest(g) = most;
      });
}

/// Closes the points that press and opens the others, in groups that may change.
template <class Exec, class Memory>
void close_pressing(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                    const Kokkos::View<double*, Memory>& change, const Kokkos::View<char*, Memory>& may_change) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::active_set", Kokkos::RangePolicy<Exec>(exec, 0, groups.num_groups()),
      KOKKOS_LAMBDA(const int g) {
        if (!may_change(g)) return;
        const double gap = groups.initial_gap(g) + change(g);
        const NormalContact law = groups.law(g);
        for (int q = groups.first_point(g); q < groups.first_point(g + 1); ++q)
          groups.active(q) = law.is_closed(groups.closed_pressure(g, q, gap)) ? 1 : 0;
      });
}

/// Computes the force of all points of each group, N, at the gap start + t step, less that of those taken for closed;
/// zero where the present active set is linear: bonded groups, and zones smaller than the cells. start and step:
/// changes of the mean gap, m.
template <class Exec, class Memory>
void excess_forces(const Exec& exec, const ContactGroupArrays<Memory>& groups,
                   const Kokkos::View<double*, Memory>& start, const Kokkos::View<double*, Memory>& step, double t,
                   const Kokkos::View<double*, Memory>& excess) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::excess_forces", Kokkos::RangePolicy<Exec>(exec, 0, groups.num_groups()),
      KOKKOS_LAMBDA(const int g) {
        const NormalContact law = groups.law(g);
        double sum = 0;
        const double gap = groups.initial_gap(g) + start(g) + t * step(g);
        if (!law.bonded && !groups.in_zone(g))
          for (int q = groups.first_point(g); q < groups.first_point(g + 1); ++q) {
            const double closed = groups.closed_pressure(g, q, gap);
            sum += groups.weight(q) * ((law.is_closed(closed) ? closed : 0) - (groups.active(q) ? closed : 0));
          }
        excess(g) = sum;
      });
}

}  // namespace cgcontact
