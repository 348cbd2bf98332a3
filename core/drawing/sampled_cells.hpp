/// Inside of a body for sections that a reader chooses: its cells with values at their corners, blocks of cells as one
/// where there are too many.
#pragma once

#include <array>
#include <vector>

#include "core/drawing/scene_view.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Cut cells are whole cubes here: the boundary of the body says where it ends.
struct SampledCells {
  std::vector<Vec3> position, displacement;  ///< of the corners, m, undeformed; each corner once
  std::vector<Sym3> stress;                  ///< recovered, Pa; empty: none
  std::vector<std::array<int, 8>> blocks;    ///< corners: bits x, y, z of the grid
  std::vector<int> cell;                     ///< of each block, an active cell in it
  std::vector<double> stress_error;          ///< of each block, the largest of its cells, Pa; empty: none
  std::vector<unsigned char> status;         ///< of each block, the largest of its cells; empty: none
  int largest_block = 1;                     ///< cells along the side of the largest one
};

/// Samples at most about `most` blocks; near the zones they are cells as long as possible. A corner of a block outside
/// of all cells has the value of the nearest cell of the block.
SampledCells sample_cells(const BodyFields& body, const std::vector<SceneBox>& zones, std::size_t most);

}  // namespace cgcontact
