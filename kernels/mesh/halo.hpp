/// Ghost nodes of a rank. A rank works on the cells around its own nodes; of the nodes of these cells some
/// belong to other ranks: ghost nodes. A vector of a rank has entries for all its local nodes, as DofMap says, where a
/// ghost node is treated as a constrained one, whose master is the same node of its owner:
///   displacements   ghosts have the value of their owner     import_ghosts: one message per neighbour
///   forces          zero at ghosts                           zero_others: the owner computes all of its forces itself
/// So the product of both is summed right over the ranks, each node once.
#pragma once

#include <vector>

#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/messages.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Returns the communicator of this rank alone.
Messages::Comm comm_of_this_rank();

class Halo {
 public:
  using Comm = Messages::Comm;

  /// Role of a local node on its rank. `unused`: comes with a cell of which other nodes are needed.
  enum class Role : char { owned, ghost, constrained, unused };

  /// Makes the halo from each local node's number among the nodes of all ranks (ascending), the rank that owns it, its
  /// role, and whether forces on it are computed here (owned nodes, and those that they constrain). Collective.
  Halo(const Comm& comm, const std::vector<int>& numbers, const std::vector<int>& owners,
       const std::vector<Role>& roles, std::vector<char> needed);
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;

  /// Returns whether forces on this node are computed here.
  bool needs(int node) const { return needed_[node] != 0; }
  int num_owned() const { return static_cast<int>(owned_.extent(0)); }
  int num_ghosts() const { return static_cast<int>(ghosts_.extent(0)); }
  const IntView& owned() const { return owned_; }    ///< ascending
  const IntView& others() const { return others_; }  ///< neither owned nor constrained

  /// Sets x (of all local degrees of freedom) at ghosts to x at their owners. Collective.
  void import_ghosts(double* x) const;
  void import_ghosts(float* x) const;
  const Comm& comm() const { return comm_; }

 private:
  template <class Real>
  void exchange(Real* x, const Kokkos::View<Real*, MemSpace>& out, const Kokkos::View<Real*, MemSpace>& in) const;

  Comm comm_;
  std::vector<char> needed_;
  IntView owned_, ghosts_, others_;
  IntView sent_, received_;  ///< local nodes in the order of the messages
  Messages messages_;
  Kokkos::View<double*, MemSpace> out_, in_;
  Kokkos::View<float*, MemSpace> out_single_, in_single_;
};

}  // namespace cgcontact
