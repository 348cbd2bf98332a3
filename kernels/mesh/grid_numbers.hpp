/// Number of each node of a body by its place in the grid.
#pragma once

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// By Grid::node_index: number among the nodes of all bodies, -1 where no active cell has a corner.
std::vector<int> numbers_on_grid(const BodyMesh& mesh);

}  // namespace cgcontact
