/// Kernels over support points and over the nodes that supports and contact act on. Sums over points run node by node
/// in the order of the points: bitwise the same on any number of threads.
#pragma once

#include "contact/kernels/group_kernels.hpp"
#include "core/base/numbers/types.hpp"
#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/hex.hpp"

namespace cgcontact {

/// Points of bodies and a direction at each: global axes, m.
template <class Memory>
struct DirectionArrays {
  Kokkos::View<int*, Memory> body;
  Kokkos::View<double*[3], Kokkos::LayoutRight, Memory> x, direction;

  DirectionArrays() = default;
  explicit DirectionArrays(std::size_t size)
      : body("cgcontact::contact::body", size),
        x("cgcontact::contact::x", size),
        direction("cgcontact::contact::direction", size) {}
};

/// Computes moved(i) = direction . motions(body).at(x), m: the displacements by the rigid motions of the bodies.
template <class Exec, class Memory, class Motions>
void rigid_displacements(const Exec& exec, const DirectionArrays<Memory>& points, const Motions& motions,
                         const Kokkos::View<double*, Memory>& moved) {
  static_assert(reaches<Exec, Memory> && reaches<Exec, typename Motions::memory_space>);
  Kokkos::parallel_for(
      "cgcontact::contact::rigid_displacements", Kokkos::RangePolicy<Exec>(exec, 0, static_cast<int>(moved.extent(0))),
      KOKKOS_LAMBDA(const int i) {
        const Vec3 at = motions(points.body(i)).at(Vec3(points.x(i, 0), points.x(i, 1), points.x(i, 2)));
        moved(i) = points.direction(i, 0) * at[0] + points.direction(i, 1) * at[1] + points.direction(i, 2) * at[2];
      });
}

/// Support points in their cells.
template <class Memory>
struct SupportArrays {
  using Values = Kokkos::View<double*, Memory>;

  Kokkos::View<int* [8], Kokkos::LayoutRight, Memory> nodes;                  ///< of the cell, of all bodies
  Kokkos::View<double*[3], Kokkos::LayoutRight, Memory> xi, local_direction;  ///< cell coordinates; grid axes
  Values weight, k;                                                           ///< m^2, Pa/m
  Values value;            ///< displacement along the direction that is prescribed, m
  Values lagged;           ///< sigma*, in units of lagged_unit
  double lagged_unit = 1;  ///< Pa

  SupportArrays() = default;
  explicit SupportArrays(std::size_t size)
      : nodes("cgcontact::contact::support_nodes", size),
        xi("cgcontact::contact::support_xi", size),
        local_direction("cgcontact::contact::support_direction", size),
        weight("cgcontact::contact::support_weight", size),
        k("cgcontact::contact::support_k", size),
        value("cgcontact::contact::support_value", size),
        lagged("cgcontact::contact::support_lagged", size) {}
  int size() const { return static_cast<int>(weight.extent(0)); }
};

/// Adds factor * u along the direction of each support to moved(s).
template <class Exec, class Memory, class U>
void add_displacements(const Exec& exec, const SupportArrays<Memory>& supports, const U& u, double factor,
                       const Kokkos::View<double*, Memory>& moved) {
  static_assert(reaches<Exec, Memory> && reaches<Exec, typename U::memory_space>);
  Kokkos::parallel_for(
      "cgcontact::contact::support_displacements", Kokkos::RangePolicy<Exec>(exec, 0, supports.size()),
      KOKKOS_LAMBDA(const int s) {
        double N[8], sum = 0;
        hex_shape(&supports.xi(s, 0), N);
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i) sum += N[a] * supports.local_direction(s, i) * u(dof_of(supports.nodes(s, a), i));
        moved(s) += factor * sum;
      });
}

/// Computes the tractions of supports that have moved along their directions, Pa: sigma* - k (moved - value).
template <class Exec, class Memory>
void support_tractions(const Exec& exec, const SupportArrays<Memory>& supports,
                       const Kokkos::View<double*, Memory>& moved, const Kokkos::View<double*, Memory>& traction) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::support_tractions", Kokkos::RangePolicy<Exec>(exec, 0, supports.size()),
      KOKKOS_LAMBDA(const int s) {
        traction(s) = supports.lagged(s) * supports.lagged_unit - supports.k(s) * (moved(s) - supports.value(s));
      });
}

/// Computes forces of supports in terms of `unit` (N): of the lagged stresses, and of what is prescribed beyond `moved`
/// (m).
template <class Exec, class Memory>
void support_amounts(const Exec& exec, const SupportArrays<Memory>& supports,
                     const Kokkos::View<double*, Memory>& moved, double unit,
                     const Kokkos::View<double*, Memory>& of_stress, const Kokkos::View<double*, Memory>& of_value) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::support_amounts", Kokkos::RangePolicy<Exec>(exec, 0, supports.size()),
      KOKKOS_LAMBDA(const int s) {
        const double area = supports.weight(s) / unit;
        of_stress(s) = area * (supports.lagged(s) * supports.lagged_unit);
        of_value(s) = area * (supports.k(s) * (supports.value(s) - moved(s)));
      });
}

/// The nodes that supports and contact act on, and what acts on each: supports, by the corner of their cell that the
/// node is, and groups with the coefficients of their rows.
template <class Memory>
struct TouchedNodes {
  using Numbers = Kokkos::View<int*, Memory>;
  using Values = Kokkos::View<double*, Memory>;

  Numbers node;                           ///< ascending or not, each once
  Numbers support_begin, support_corner;  ///< (nodes + 1); entries: 8 * support + corner
  Numbers group_begin, group;             ///< by degree of freedom: (3 nodes + 1); entries
  Values coefficient;                     ///< of the entries
  int size() const { return static_cast<int>(node.extent(0)); }
};

/// Adds forces at the touched degrees of freedom: of supports, sum of shape * direction * amount(support).
template <class Exec, class Memory>
void add_support_forces(const Exec& exec, const TouchedNodes<Memory>& touched, const SupportArrays<Memory>& supports,
                        const Kokkos::View<double*, Memory>& amount, const Kokkos::View<double*, Memory>& force) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::support_forces", Kokkos::RangePolicy<Exec>(exec, 0, touched.size()),
      KOKKOS_LAMBDA(const int t) {
        double sum[dofs_per_node];
        for (int i = 0; i < dofs_per_node; ++i) sum[i] = force(dof_of(t, i));
        for (int e = touched.support_begin(t); e < touched.support_begin(t + 1); ++e) {
          const int s = touched.support_corner(e) / 8;
          double N[8];
          hex_shape(&supports.xi(s, 0), N);
          const double term = N[touched.support_corner(e) % 8] * amount(s);
          for (int i = 0; i < dofs_per_node; ++i) sum[i] += supports.local_direction(s, i) * term;
        }
        for (int i = 0; i < dofs_per_node; ++i) force(dof_of(t, i)) = sum[i];
      });
}

/// Adds those of contact groups: sum of coefficient * amount(group).
template <class Exec, class Memory>
void add_contact_forces(const Exec& exec, const TouchedNodes<Memory>& touched,
                        const Kokkos::View<double*, Memory>& amount, const Kokkos::View<double*, Memory>& force) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::nodal_forces", Kokkos::RangePolicy<Exec>(exec, 0, dof_of(touched.size())),
      KOKKOS_LAMBDA(const int d) {
        double sum = force(d);
        for (int e = touched.group_begin(d); e < touched.group_begin(d + 1); ++e)
          sum += touched.coefficient(e) * amount(touched.group(e));
        force(d) = sum;
      });
}

/// Puts the forces into the vector of all degrees of freedom.
template <class Exec, class Memory>
void put_at_nodes(const Exec& exec, const TouchedNodes<Memory>& touched, const Kokkos::View<double*, Memory>& force,
                  const Kokkos::View<double*, Memory>& vector) {
  static_assert(reaches<Exec, Memory>);
  Kokkos::parallel_for(
      "cgcontact::contact::put_at_nodes", Kokkos::RangePolicy<Exec>(exec, 0, touched.size()),
      KOKKOS_LAMBDA(const int t) {
        for (int i = 0; i < dofs_per_node; ++i) vector(dof_of(touched.node(t), i)) = force(dof_of(t, i));
      });
}

}  // namespace cgcontact
