/// The first grids of bodies without a cell size, from their shape.
#pragma once

#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Returns the cell size of each body, m: its cell_size; else by the number of cells that [accuracy] gives over the
/// mean thickness (twice the volume over the unsupported surface), at least one over its shortest side, fewer where the
/// total is too large. Throws InputError for a body without volume or a face without points.
std::vector<double> first_cell_sizes(const Scene& scene);

}  // namespace cgcontact
