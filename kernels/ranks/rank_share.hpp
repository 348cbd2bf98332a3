/// Share of a system that one rank works on: the cells around its own nodes and those of their ghost faces, as a system
/// of its own with its own numbers. Forces on its own nodes are complete: ranks exchange displacements (Halo), and both
/// compute a cell on the border between them. The rows of contact groups keep only entries at the rank's own nodes;
/// their gaps are summed over the ranks that share them (RowSums).
#pragma once

#include <memory>
#include <vector>

#include "kernels/mesh/halo.hpp"
#include "kernels/ranks/partition.hpp"

namespace cgcontact {

class RankShare {
 public:
  /// Makes the share; more: marks nodes of the whole system that are also local. Collective.
  RankShare(const ElasticSystem& whole, Owners owners, const std::vector<char>& more, const Halo::Comm& comm);

  const ElasticSystem& system() const { return system_; }
  bool owns(int whole_node) const;
  /// Returns the local number of a node of the whole system, or -1.
  int local(int whole_node) const { return local_of_whole_[whole_node]; }
  const std::vector<int>& whole_nodes() const { return whole_nodes_; }  ///< of each local node, ascending

  /// Adds this rank's counts to RankWork (core/base/process/ranks.hpp).
  void record_counts() const;

  /// Takes over the rows of the contact groups of the whole system, unless it has the same, and their stiffness.
  /// Collective.
  void set_groups(const std::vector<GroupRow>& rows, const std::vector<double>& stiffness, bool same_rows);
  /// Takes the coupling of all rows, after these; of the grid that this is the share of.
  void take_coupling(const ElasticSystem& whole);
  /// Returns rows with the entries at own nodes alone, in local numbers.
  std::vector<GroupRow> own_entries(const std::vector<GroupRow>& rows) const;

  /// Copies the entries of all local nodes out of a vector of the whole system.
  void to_local(const RealView& whole, const RealView& local) const;
  /// Collects own values of all ranks, in the numbers of the whole system; constrained nodes stay. Collective.
  void to_whole(const RealView& local, const RealView& whole) const;
  void to_local(const Kokkos::View<float*, MemSpace>& whole, const Kokkos::View<float*, MemSpace>& local) const;
  void to_whole(const Kokkos::View<float*, MemSpace>& local, const Kokkos::View<float*, MemSpace>& whole) const;

  /// Drops the cells once no more operators are made.
  void drop_cells();

 private:
  void set_group_sums();
  template <class View>
  void copy_to_local(const View& whole, const View& local) const;
  template <class View>
  void gather_whole(const View& local, const View& whole) const;

  Owners owners_;
  std::vector<CutCells> cells_;
  ElasticSystem system_;
  std::vector<int> whole_nodes_, local_of_whole_;
  std::vector<int> order_;  ///< free nodes of the whole system by owner, ascending for each: as they are gathered
};

/// Forgets cells, their moments and nodes, and the supports: once operators have been made, nothing is needed but the
/// positions of nodes.
void drop_cells(std::vector<CutCells>& bodies, ElasticSystem& system);

/// Marks nodes of the whole system on which a rank computes forces: its own, and constrained ones with a master of its
/// own.
std::vector<char> needed_nodes(const ElasticSystem& whole, const Owners& owners, int rank);

}  // namespace cgcontact
