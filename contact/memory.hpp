/// Does a scene fit into memory? Estimated before anything large is made, and again when the cells are known.
#pragma once

#include <vector>

#include "contact/model.hpp"

namespace cgcontact {

/// What the memory of a run depends on, of one body.
struct BodySize {
  double grid_cells = 0, nodes = 0, cut_cells = 0;
};

/// Without making the body's cells: from its cells on a coarser grid.
BodySize estimate_size(const BodySpec& body);
BodySize size_of(const CutCells& cut_cells);

/// Expected peak memory of a run in bytes: a measured model.
double expected_memory(const std::vector<BodySize>& bodies);

/// Throws InputError if `needed_part` of the expected memory is more than there is (memory_budget), and names the cell
/// sizes that would fit.
void check_memory(const Scene& scene, const std::vector<BodySize>& bodies, double needed_part = 1);

}  // namespace cgcontact
