/// Partition of cells and nodes among the ranks. Blocks of 4 x 4 x 4 cells of one level along a Morton curve through
/// the box of all bodies, so that facing regions of two bodies mostly go to the same rank, are divided by weight until
/// the work of the ranks, with that at borders which several do, is the same to some percent. Every rank computes the
/// same division.
#pragma once

#include <vector>

#include "kernels/operator/system.hpp"

namespace cgcontact {

struct Owners {
  std::vector<std::vector<int>> of_cell;  ///< rank, of each cell of each level
  std::vector<int> of_node;  ///< of each node: that of the first of its cells; of constrained nodes 0 or more
};

/// Divides the finest grid. `together`: lists of nodes that belong to one rank (columns through thin bodies).
Owners partition(const ElasticSystem& system, int num_ranks, const std::vector<std::vector<int>>& together);

/// Finds the owners of nodes from those of cells.
void own_nodes(const ElasticSystem& system, const std::vector<std::vector<int>>& together, Owners& owners);

}  // namespace cgcontact
