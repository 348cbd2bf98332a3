/// Classification of a grid's cells (inside a body, or possibly cut) by bisecting blocks of cells.
#pragma once

#include <vector>

#include "core/cells/cell_tree.hpp"
#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"
#include "core/geometry/body_geometry.hpp"

namespace cgcontact {

struct CellClasses {
  GridNumbers inside;              ///< wholly inside, touched by no surface
  std::vector<Index3> candidates;  ///< cells that a surface may cross, also just outside of the grid; by k, j, i
};

/// The leaves of one level of a tree; of a quadtree (Grid::slice) those of index 0 across.
struct LeafLevel {
  const CellTree* tree = nullptr;  ///< nullptr: all cells
  int level = 0;
  int across = -1;  ///< axis across which there is one layer; -1: none
  bool all() const { return !tree && across < 0; }
  bool has(const Index3& cell) const {
    return (across < 0 || cell[across] == 0) && (!tree || tree->is_leaf(level, cell));
  }
};

/// Classifies cells by BodyGeometry::side_of_block, in the coordinates of the grid (of that level). Throws InputError
/// if a cell outside of the grid is wholly inside.
CellClasses classify_cells(const BodyGeometry& body, const Grid& grid, const LeafLevel& leaves = {});

/// Estimates as BodyGeometry::estimate_cells, for a body in global axes, by classifying the cells of a coarser grid.
CellEstimate estimate_by_coarse_cells(const BodyGeometry& body, const Grid& grid, double max_cells);

}  // namespace cgcontact
