/// One cell of a boolean expression of surfaces: the surfaces that cross it, its moments, and the facets of the
/// boundary in it.
#pragma once

#include <vector>

#include "core/bodies/local_solid.hpp"
#include "core/cells/boundary_points.hpp"
#include "core/cells/moments.hpp"

namespace cgcontact {

/// Areas over a cell's face that are rounding: of one surface in a cell, and of what dividers leave of it.
constexpr double lost_facet = 1e-14, lost_group = 1e-15;

/// Integrates the moments of the body in the cell `cell` of the grid (in grid coordinates).
Moments cell_moments(const CsgBody& solid, const LocalSolid& local, const Index3& cell);

/// Adds points on the facets of the body's boundary in a cell; `selected`: its surfaces, empty: all. `points.cell` is
/// set to `owner`.
void cell_boundary_points(const CsgBody& solid, const LocalSolid& local, const Index3& cell,
                          const std::vector<char>& selected, const std::vector<Plane>& dividers, int order, int owner,
                          BoundaryPoints& points);

}  // namespace cgcontact
