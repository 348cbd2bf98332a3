/// The grid of a body, found again in its cells, so that its lines can be drawn.
#pragma once

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// Sets grid coordinates and levels of a mesh whose points have none. `cell_size`: of the largest cells, m; `active`:
/// of each polyhedron, its active cell. A cut cell whose part in the body fits into a smaller cell counts as one of
/// those, where the body has any. Without a whole cell nothing changes: no lines.
void find_grid(double cell_size, const long long* active, DrawnBody& body);

}  // namespace cgcontact
