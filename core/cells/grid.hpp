/// The Cartesian grid of one body: cubic cells, any origin and rotation, unrelated to the body's faces. A list of
/// levels: those of level 0 are the largest, each next level halves them. How large a cell is comes from its level
/// (CutCells::h).
#pragma once

#include <cmath>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Grid coordinates are in cells of level 0: cell (i,j,k) of level 0 is [i,i+1] x [j,j+1] x [k,k+1].
struct Grid {
  Vec3 origin = Vec3::Zero();        ///< position of grid node (0,0,0), m
  Mat3 rotation = Mat3::Identity();  ///< columns: grid axes in global axes
  double cell_size = 1;              ///< of level 0: the unit of the grid coordinates, m
  Index3 num_cells{0, 0, 0};         ///< of level 0
  int num_levels = 1;
  /// Axis of the grid across which the body is one layer of cells thick and nothing varies (plane strain): nodes that
  /// differ in it only share their displacements, whose component along it is zero. -1: none.
  int plane_strain = -1;
  /// In plane strain on a quadtree, cells of index 0 across on every level: the thickness for which each of them
  /// counts, whatever its size, m. 0: no quadtree, cells count for their own.
  double slice = 0;
  /// On a quadtree: where all points are along plane_strain, in global axes too (it is turned about that axis only), m.
  double middle = 0;
  double thickness = 0;  ///< on a quadtree: of the body across, m; of a body of revolution 2 pi unit_radius
  /// Radius, m, at which cells of a body of revolution (a quadtree in a half-plane through its axis) count for the
  /// thickness of the slice, elsewhere in proportion to the radius. The axis lies at 0 of radial_axis(), in global axes
  /// as well (the grid is not turned). 0: no body of revolution.
  double unit_radius = 0;

  bool is_axisymmetric() const { return unit_radius > 0; }
  /// Axes of the grid away from the axis of revolution, and along it: both follow the one across.
  int radial_axis() const { return (plane_strain + 2) % 3; }
  int axis_of_revolution() const { return (plane_strain + 1) % 3; }
  /// Returns the distance of a point from the axis of revolution, m.
  double radius(const Vec3& g) const { return origin[radial_axis()] + cell_size * g[radial_axis()]; }
  /// Returns the thickness that a point counts for, over the slice. 1: no body of revolution.
  double ring(const Vec3& g) const { return is_axisymmetric() ? radius(g) / unit_radius : 1; }
  bool is_quadtree() const { return slice > 0; }
  double cell_size_of(int level) const { return std::ldexp(cell_size, -level); }
  /// Thickness for which a cell of a level counts, in cells of that level.
  double thickness_of_cell(int level) const { return is_quadtree() ? slice / cell_size_of(level) : 1; }
  /// Returns the factor from integrals over the cells to those of the body's whole thickness.
  double slices() const { return is_quadtree() ? thickness / slice : 1; }
  /// Returns grid coordinates; on a quadtree in the smallest cells, wherever x is across: so cells of all levels hold
  /// it.
  Vec3 to_grid(const Vec3& x) const {
    Vec3 g = rotation.transpose() * (x - origin) / cell_size;
    if (is_quadtree()) g[plane_strain] = std::ldexp(0.5, 1 - num_levels);
    return g;
  }
  Vec3 to_global(const Vec3& g) const { return in_layer(origin + cell_size * (rotation * g)); }
  /// Moves a point to the middle of a quadtree's layer: nothing varies across.
  Vec3 in_layer(Vec3 x) const {
    if (is_quadtree()) x[plane_strain] = middle;
    return x;
  }
};

}  // namespace cgcontact
