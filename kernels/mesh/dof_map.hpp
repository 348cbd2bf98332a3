/// The nodes of this rank and their degrees of freedom: owned nodes, ghost nodes (owned by another rank, or copies of
/// an owned one), and constrained nodes, whose value is a weighted sum of other nodes (hanging nodes where small cells
/// meet large ones, the two sides of a body in plane strain). Local numbers: owned nodes first, ghosts after them.
/// Single degrees of freedom may be zero (across a body in plane strain): that belongs to the constraints.
///
/// A vector of free values x becomes a vector of all local values P x by two steps, each with its transpose:
///   ghosts       doImport with the importer, REPLACE    doExport, ADD_ASSIGN, into zero (ADD loses copies)
///   constraints  apply_constraints                      apply_constraints_transposed
/// The products run with one rank today, and without constraints where all cells are of one size and no body is in
/// plane strain; then both steps are the identity and cost nothing.
///
/// Two kinds of vectors: displacements are consistent (constrained nodes have the value that their masters give them),
/// forces and residuals are zero at constrained nodes; both at what is zero. Sums of each kind are of that kind, and
/// the product of one with the other is that of the free values.
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>
#include <Tpetra_Import_fwd.hpp>
#include <Tpetra_Map_fwd.hpp>
#include <utility>
#include <vector>

#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

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
using TwinsView = Kokkos::View<int* [2], Kokkos::LayoutRight, MemSpace>;

class DofMap {
 public:
  using Map = Tpetra::Map<>;
  using Import = Tpetra::Import<>;
  using Comm = Teuchos::RCP<const Teuchos::Comm<int>>;

  /// One rank owns all nodes; global numbers are local ones. Throws InputError if there are more than 32-bit numbers of
  /// degrees of freedom hold.
  explicit DofMap(long long num_nodes = 0, const std::vector<NodeConstraint>& constraints = {},
                  const std::vector<int>& zero_dofs = {});

  /// Global numbers of the owned nodes (each once) and of the ghosts. Throws std::invalid_argument where a number is
  /// negative or owned twice, and where a constraint names a node that does not exist, constrains a node twice, has no
  /// master, the same master twice or a weight that is not finite, or has a constrained node as its master: chains are
  /// to be resolved by who makes the constraints.
  DofMap(const std::vector<long long>& owned, const std::vector<long long>& ghosts,
         const std::vector<NodeConstraint>& constraints = {});

  int num_owned_nodes() const { return num_owned_; }
  int num_ghost_nodes() const { return num_nodes_ - num_owned_; }
  int num_constrained_nodes() const { return static_cast<int>(twins_.extent(0)) + sums_.num_nodes(); }
  int num_nodes() const { return num_nodes_; }
  int num_owned_dofs() const { return dof_of(num_owned_); }
  int num_dofs() const { return dof_of(num_nodes_); }
  long long global_node(int node) const { return one_rank_ ? node : global_[node]; }
  /// The constraints are of two kinds: nodes that equal a master which no other node depends on (across a body in plane
  /// strain, half of all nodes), and the others.
  const TwinsView& twins() const { return twins_; }
  const ConstraintRows& sums() const { return sums_; }
  const IntView& zero_dofs() const { return zero_dofs_; }

  /// Maps of the degrees of freedom and of the nodes; with ghosts the local ones overlap.
  Teuchos::RCP<const Map> owned_map(const Comm& comm) const;
  Teuchos::RCP<const Map> local_map(const Comm& comm) const;
  Teuchos::RCP<const Map> owned_node_map(const Comm& comm) const;
  /// From owned to local values.
  Teuchos::RCP<const Import> importer(const Comm& comm) const;

 private:
  void set_constraints(const std::vector<NodeConstraint>& constraints);
  Teuchos::RCP<const Map> map_of(int num_nodes, int per_node, const Comm& comm) const;

  int num_owned_ = 0, num_nodes_ = 0;
  bool one_rank_ = true;           ///< global numbers are local ones
  std::vector<long long> global_;  ///< else: of each local node
  TwinsView twins_;
  ConstraintRows sums_;
  IntView zero_dofs_;
};

template <class Exec, class X>
void set_to_zero(const Exec& exec, const IntView& dofs, const X& x) {
  if (dofs.extent(0) == 0) return;
  Kokkos::parallel_for(
      "cgcontact::dof_map::zero_dofs", Kokkos::RangePolicy<Exec>(exec, 0, dofs.extent(0)),
      KOKKOS_LAMBDA(const int i) { x(dofs(i)) = 0; });
}

/// x at constrained nodes = weighted sums of x at their masters, x = 0 where it is to be. x: DofMap::num_dofs entries.
template <class Exec, class X>
void apply_constraints(const Exec& exec, const DofMap& dofs, const X& x) {
  set_to_zero(exec, dofs.zero_dofs(), x);
  const TwinsView twins = dofs.twins();
  if (twins.extent(0) > 0)
    Kokkos::parallel_for(
        "cgcontact::dof_map::twins", Kokkos::RangePolicy<Exec>(exec, 0, twins.extent(0)), KOKKOS_LAMBDA(const int t) {
          for (int i = 0; i < dofs_per_node; ++i) x(dof_of(twins(t, 1), i)) = x(dof_of(twins(t, 0), i));
        });
  const ConstraintRows rows = dofs.sums();
  if (rows.num_nodes() == 0) return;
  using Real = typename X::non_const_value_type;
  Kokkos::parallel_for(
      "cgcontact::dof_map::constraints", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_nodes()),
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

/// The transpose: y at masters += weights times y at the nodes they constrain, which become zero. No atomics: each
/// master gathers.
template <class Exec, class Y>
void apply_constraints_transposed(const Exec& exec, const DofMap& dofs, const Y& y) {
  const TwinsView twins = dofs.twins();
  if (twins.extent(0) > 0)
    Kokkos::parallel_for(
        "cgcontact::dof_map::twins_transposed", Kokkos::RangePolicy<Exec>(exec, 0, twins.extent(0)),
        KOKKOS_LAMBDA(const int t) {
          for (int i = 0; i < dofs_per_node; ++i) {
            y(dof_of(twins(t, 0), i)) += y(dof_of(twins(t, 1), i));
            y(dof_of(twins(t, 1), i)) = 0;
          }
        });
  const ConstraintRows rows = dofs.sums();
  if (rows.num_nodes() == 0) return set_to_zero(exec, dofs.zero_dofs(), y);
  using Real = typename Y::non_const_value_type;
  Kokkos::parallel_for(
      "cgcontact::dof_map::constraints_transposed", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_masters()),
      KOKKOS_LAMBDA(const int m) {
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
  Kokkos::parallel_for(
      "cgcontact::dof_map::constrained_to_zero", Kokkos::RangePolicy<Exec>(exec, 0, rows.num_nodes()),
      KOKKOS_LAMBDA(const int c) {
        for (int i = 0; i < dofs_per_node; ++i) y(dof_of(rows.node(c), i)) = 0;
      });
  set_to_zero(exec, dofs.zero_dofs(), y);
}

}  // namespace cgcontact
