/// Nodes of this rank and their degrees of freedom, some of which are not free: constrained nodes, whose value is a
/// weighted sum of other nodes (hanging nodes, the two sides of a body in plane strain), and ghost nodes, whose value
/// is that of the rank that owns them (halo.hpp). Single degrees of freedom may be zero (across a body in plane
/// strain): that belongs to the constraints.
///
/// Two kinds of vectors, both with entries for all local nodes: displacements are consistent (apply_constraints: ghost
/// nodes have the value of their owner, constrained ones that of their masters); forces and residuals are zero at ghost
/// and constrained nodes (apply_constraints_transposed). Sums of each kind are of that kind, and the product of one
/// with the other is that of the free values, summed over the ranks. On one rank without constraints both functions do
/// nothing.
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/launch.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

class Halo;
/// Give apply_constraints and its transpose the data of ghosts (halo.hpp).
void import_ghosts(const Halo& halo, double* x);
void import_ghosts(const Halo& halo, float* x);
const IntView& nodes_of_others(const Halo& halo);

/// Each component: u(node) = sum of weight * u(master). Local node numbers.
struct NodeConstraint {
  int node;
  std::vector<std::pair<int, double>> masters;
};

/// Constraints by constrained node and, for the transpose, by master, both compressed.
struct ConstraintRows {
  IntView node, begin, master;  ///< constrained nodes; first entry of each, and the end; masters
  RealView weight;
  IntView master_node, master_begin, constrained;  ///< masters; first entry of each, and the end; constrained nodes
  RealView master_weight;

  int num_nodes() const { return static_cast<int>(node.extent(0)); }
  int num_masters() const { return static_cast<int>(master_node.extent(0)); }
};

/// (pair, master and constrained node)
using AcrossNodesView = Kokkos::View<int* [2], Kokkos::LayoutRight, MemSpace>;

class DofMap {
 public:
  using Map = Tpetra::Map<>;
  using Comm = Teuchos::RCP<const Teuchos::Comm<int>>;

  /// Without a halo no other rank shares these nodes. Throws InputError if degrees of freedom exceed 32-bit numbers;
  /// std::invalid_argument where a constraint names a node that does not exist, constrains a node twice, has no master,
  /// the same master twice or a weight that is not finite, or has a constrained node as its master: the caller resolves
  /// chains.
  explicit DofMap(long long num_nodes = 0, const std::vector<NodeConstraint>& constraints = {},
                  const std::vector<int>& zero_dofs = {}, std::shared_ptr<const Halo> halo = nullptr);

  int num_constrained_nodes() const { return static_cast<int>(across_nodes_.extent(0)) + sums_.num_nodes(); }
  int num_nodes() const { return num_nodes_; }
  int num_dofs() const { return dof_of(num_nodes_); }
  /// Return the two kinds of constraints: nodes that equal a master which no other node depends on (across a body in
  /// plane strain, half of all nodes), and the others.
  const AcrossNodesView& across_nodes() const { return across_nodes_; }
  const ConstraintRows& sums() const { return sums_; }
  const IntView& zero_dofs() const { return zero_dofs_; }
  /// Returns the halo of other ranks' nodes, nullptr: none.
  const Halo* halo() const { return halo_.get(); }

  /// Return the map of a vector's entries: as many on every rank as it has local degrees of freedom, or nodes.
  Teuchos::RCP<const Map> vector_map(const Comm& comm) const;
  Teuchos::RCP<const Map> node_map(const Comm& comm) const;

 private:
  void set_constraints(const std::vector<NodeConstraint>& constraints);

  int num_nodes_ = 0;
  AcrossNodesView across_nodes_;
  ConstraintRows sums_;
  IntView zero_dofs_;
  std::shared_ptr<const Halo> halo_;
};

template <class Exec, class X>
void set_to_zero(const Exec& exec, const IntView& dofs, const X& x) {
  if (dofs.extent(0) == 0) return;
  launch(
      "cgcontact::dof_map::zero_dofs", Kokkos::RangePolicy<Exec>(exec, 0, dofs.extent(0)), grain_of_light,
      KOKKOS_LAMBDA(const int i) { x(dofs(i)) = 0; });
}

/// x at ghosts = x at their owners, x at constrained nodes = weighted sums of x at their masters, x = 0 where it is to
/// be. x: DofMap::num_dofs entries, contiguous. Collective with a halo.
template <class Exec, class X>
void apply_constraints(const Exec& exec, const DofMap& dofs, const X& x) {
  if (dofs.halo()) {
    exec.fence();
    import_ghosts(*dofs.halo(), x.data());
  }
  set_to_zero(exec, dofs.zero_dofs(), x);
  const AcrossNodesView across_nodes = dofs.across_nodes();
  if (across_nodes.extent(0) > 0)
    launch(
        "cgcontact::dof_map::across_nodes", Kokkos::RangePolicy<Exec>(exec, 0, across_nodes.extent(0)), grain_of_light,
        KOKKOS_LAMBDA(const int t) {
          for (int i = 0; i < dofs_per_node; ++i) x(dof_of(across_nodes(t, 1), i)) = x(dof_of(across_nodes(t, 0), i));
        });
  const ConstraintRows rows = dofs.sums();
  if (rows.num_nodes() == 0) return;
  using Real = typename X::non_const_value_type;
  launch(
      "cgcontact::dof_map::constraints", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_nodes()), grain_of_medium,
      KOKKOS_LAMBDA(const int c) {
        Real sum[dofs_per_node] = {};
        const int end = rows.begin(c + 1);
        for (int e = rows.begin(c); e < end; ++e) {
          const Real weight = static_cast<Real>(rows.weight(e));
          const int master = rows.master(e);
          for (int i = 0; i < dofs_per_node; ++i) sum[i] += weight * x(dof_of(master, i));
        }
        const int node = rows.node(c);
        for (int i = 0; i < dofs_per_node; ++i) x(dof_of(node, i)) = sum[i];
      });
}

/// Sets y = 0 at the nodes of other ranks.
template <class Exec, class Y>
void zero_others(const Exec& exec, const DofMap& dofs, const Y& y) {
  if (!dofs.halo()) return;
  const IntView others = nodes_of_others(*dofs.halo());
  launch(
      "cgcontact::dof_map::others", Kokkos::RangePolicy<Exec>(exec, 0, others.extent(0)), grain_of_light,
      KOKKOS_LAMBDA(const int n) {
        for (int i = 0; i < dofs_per_node; ++i) y(dof_of(others(n), i)) = 0;
      });
}

/// Applies the transpose: y at masters += weights times y at the nodes they constrain, which become zero, as do those
/// of other ranks. No atomics: each master gathers.
template <class Exec, class Y>
void apply_constraints_transposed(const Exec& exec, const DofMap& dofs, const Y& y) {
  const AcrossNodesView across_nodes = dofs.across_nodes();
  if (across_nodes.extent(0) > 0)
    launch(
        "cgcontact::dof_map::across_nodes_transposed", Kokkos::RangePolicy<Exec>(exec, 0, across_nodes.extent(0)),
        grain_of_light, KOKKOS_LAMBDA(const int t) {
          for (int i = 0; i < dofs_per_node; ++i) {
            y(dof_of(across_nodes(t, 0), i)) += y(dof_of(across_nodes(t, 1), i));
            y(dof_of(across_nodes(t, 1), i)) = 0;
          }
        });
  const ConstraintRows rows = dofs.sums();
  if (rows.num_nodes() == 0) {
    zero_others(exec, dofs, y);
    return set_to_zero(exec, dofs.zero_dofs(), y);
  }
  using Real = typename Y::non_const_value_type;
  launch(
      "cgcontact::dof_map::constraints_transposed", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_masters()),
      grain_of_medium, KOKKOS_LAMBDA(const int m) {
        const int node = rows.master_node(m), end = rows.master_begin(m + 1);
        Real sum[dofs_per_node];
        for (int i = 0; i < dofs_per_node; ++i) sum[i] = y(dof_of(node, i));
        for (int e = rows.master_begin(m); e < end; ++e) {
          const Real weight = static_cast<Real>(rows.master_weight(e));
          const int constrained = rows.constrained(e);
          for (int i = 0; i < dofs_per_node; ++i) sum[i] += weight * y(dof_of(constrained, i));
        }
        for (int i = 0; i < dofs_per_node; ++i) y(dof_of(node, i)) = sum[i];
      });
  launch(
      "cgcontact::dof_map::constrained_to_zero", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_nodes()), grain_of_light,
      KOKKOS_LAMBDA(const int c) {
        for (int i = 0; i < dofs_per_node; ++i) y(dof_of(rows.node(c), i)) = 0;
      });
  zero_others(exec, dofs, y);
  set_to_zero(exec, dofs.zero_dofs(), y);
}

}  // namespace cgcontact
