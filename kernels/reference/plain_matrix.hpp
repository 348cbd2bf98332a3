/// The assembled matrix made entry by entry on one thread: the plain reference of kernels/assembled/assembly.hpp.
#pragma once

#include <vector>

#include "kernels/operator/system.hpp"

namespace cgcontact {

/// 3 x 3 blocks of nodes, rows compressed, columns ascending.
struct BlockMatrix {
  std::vector<std::size_t> begin;  ///< node -> first block, and the end
  std::vector<int> column;         ///< node
  std::vector<double> value;       ///< 9 per block, by rows

  double* block(int row, int col);
};

/// Adds up cells, ghost faces and contact groups in the order of their numbers.
BlockMatrix plain_matrix(const ElasticSystem& system);

}  // namespace cgcontact
