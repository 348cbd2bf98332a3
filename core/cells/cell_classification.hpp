/// Which cells of a grid are inside a solid and which may be cut, found by bisecting blocks of cells.
#pragma once

#include <vector>

#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"
#include "core/geometry/csg.hpp"

namespace cgcontact {

struct CellClasses {
  GridNumbers inside;              ///< wholly inside, touched by no surface
  std::vector<Index3> candidates;  ///< cells that a surface may cross, also just outside of the grid; by k, j, i
};

/// Throws InputError if a cell outside of the grid is wholly inside the solid.
CellClasses classify_cells(const Solid& solid, const Grid& grid);

}  // namespace cgcontact
