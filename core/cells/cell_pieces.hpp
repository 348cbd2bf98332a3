/// One cell of a body: the surfaces that cross it, its moments, and the pieces of the boundary in it.
#pragma once

#include <vector>

#include "core/cells/cut_cells.hpp"
#include "core/geometry/csg.hpp"
#include "core/quadrature/region_quadrature.hpp"

namespace cgcontact {

/// What was found in one cell that the boundary may cross.
struct CellIntegrals {
  Index3 cell;
  Moments moments;
  BoundaryPoints points;
};

/// Side of a surface on which a box lies: 1 inner, 0 outer, -1 if the surface may cross or touch it. Conservative.
int side_of_box(const Surface& surface, const Vec3& centre, const Vec3& half_size);

/// The surfaces that cross a box and matter there, and the boolean over their signs (bit i: on the inner side).
struct LocalSolid {
  std::vector<int> surfaces;
  std::vector<unsigned char> table;
  bool is_constant() const { return surfaces.empty(); }
};
/// `sides` as for Solid::evaluate_partial.
LocalSolid make_local_solid(const Solid& solid, const std::vector<signed char>& sides);
/// At most this many surfaces can cross a cell; make_local_solid throws InputError with the names of more.
constexpr int max_table_bits = 16;
/// Of the cube [corner, corner + width]^3.
LocalSolid make_local_solid(const Solid& solid, const Vec3& corner, double width);

/// Moments of the body in the cell `cell` of the grid (in grid coordinates).
Moments cell_moments(const Solid& solid, const LocalSolid& local, const Index3& cell);

/// Points on the pieces of the body's boundary in a cell; `selected` (by surface) says of which surfaces, empty: all.
/// `points.cell` is set to `owner`.
void cell_boundary_points(const Solid& solid, const LocalSolid& local, const Index3& cell,
                          const std::vector<char>& selected, const std::vector<Plane>& dividers, int order, int owner,
                          BoundaryPoints& points);

}  // namespace cgcontact
