/// From what a scene says about smaller cells (`refine`) to the tree of a body's grid.
#pragma once

#include "core/cells/cell_tree.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Cells of level l are divided if they are larger than what is wanted at one point in them: the size of a region up to
/// its distance from the region, growing by its grading times the distance beyond that. solid, dividers: in the
/// coordinates of the grid. Throws TooManyCells if there would surely be more cells than BodySpec::max_cells, or than
/// the memory holds, before they are all made.
CellTree refined_tree(const BodySpec& body, const Solid& solid, const Grid& grid, const std::vector<Plane>& dividers,
                      const GeometryOptions& options);

}  // namespace cgcontact
