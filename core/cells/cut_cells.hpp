/// Cells that a body fills, the moments of the cut ones, and quadrature points on the body's boundary. Everything here
/// is in grid coordinates (cell units, grid axes): h = 1.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/cells/boundary_points.hpp"
#include "core/cells/cell_tree.hpp"
#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"
#include "core/cells/moments.hpp"
#include "core/geometry/solid.hpp"
#include "core/settings/geometry_options.hpp"

namespace cgcontact {

/// The facets of a surface in a cell without volume of its own belong to an active neighbour.
struct MergedSliver {
  int active;    ///< cell that owns the facets
  Index3 donor;  ///< cell in which they lie (may be outside of the grid by rounding)
  int surface;
  int level = 0;  ///< of the donor
};

/// Cells of one body: the leaves of its tree that it fills or that its boundary crosses.
struct CutCells {
  Solid solid;  ///< in grid coordinates
  Grid grid;
  std::vector<Index3> cells;        ///< active cells (positive volume): index in their level; by level, k, j, i
  GridNumbers numbers;              ///< of the active cells of a grid of one level: indices into cells
  std::vector<signed char> levels;  ///< level of each active cell; empty: 0
  /// Index into moments, or -1 for an interior (full) cell; all cells of a body of revolution have moments.
  std::vector<int> cut_of_active;
  std::vector<int> active_of_cut;       ///< cut cell -> active cell
  MomentList moments;                   ///< one per cut cell, until they are dropped
  std::vector<double> fractions;        ///< volume fraction of each cut cell; empty as long as it has all moments
  std::vector<double> radii;            ///< of a body of revolution, beside the fractions: radius(), m
  BoundaryPoints boundary;              ///< default rule, all surfaces
  std::vector<MergedSliver> adoptions;  ///< ascending in active
  std::vector<Plane> face_dividers;     ///< planes at which all boundary facets are cut (core/scene/face_dividers.hpp)
  long long num_pruned = 0;  ///< cells whose volume was rounding only; their points and moments went to a neighbour

  /// Cells of each level as a grid of one level, with that level's size as the unit of the grid coordinates; without
  /// solid, boundary and adoptions. Share the moments. Empty: one level.
  std::vector<CutCells> level_cells;
  std::shared_ptr<const CellTree> tree;  ///< which cells are refined
  std::vector<Solid> level_solids;       ///< the body in the grid coordinates of each level
  std::vector<int> first_of_level;       ///< first active cell of each level, and the end

  int num_levels() const { return level_cells.empty() ? 1 : static_cast<int>(level_cells.size()); }
  int level(int active) const { return levels.empty() ? 0 : levels[active]; }
  /// Return the size of an active cell: in units of the grid coordinates; m.
  double size(int active) const { return std::ldexp(1.0, -level(active)); }
  double h(int active) const { return grid.cell_size_of(level(active)); }
  /// Returns the lower corner of an active cell, grid coordinates.
  Vec3 corner(int active) const {
    const Index3& c = cells[active];
    return size(active) * Vec3(c[0], c[1], c[2]);
  }
  double volume_fraction(int active) const {
    const int cut = cut_of_active[active];
    return cut < 0 ? 1.0 : !fractions.empty() ? fractions[cut] : moments[cut][0] / 8.0;
  }
  /// Drops the moments once nothing more is integrated over the cells: 1 kB of each cut cell becomes 8 bytes.
  void drop_moments();
  /// Keep the moments of this rank's share of the cut cells only; restore those of all ranks. Collective.
  void keep_own_moments();
  void gather_moments();

  /// Returns the mean distance of the material in a cell from the axis of revolution, m.
  double radius(int active) const;
  /// Returns the volume of the material that an active cell stands for, units of the grid coordinates.
  double volume(int active) const {
    const int l = level(active);
    const double ring = grid.is_axisymmetric() ? radius(active) / grid.unit_radius : 1;
    return ring * volume_fraction(active) * std::ldexp(grid.thickness_of_cell(l), -3 * l);
  }
  /// Return the active cell at an index triple of a level, or -1.
  int find(const Index3& c) const { return find(0, c); }
  int find(int level, const Index3& c) const {
    if (level_cells.empty()) return numbers.find(c);
    const int cell = level_cells[level].numbers.find(c);
    return cell < 0 ? -1 : first_of_level[level] + cell;
  }
  /// Finds the active cell that contains the point (grid coordinates), or the nearest active cell within one cell, or
  /// -1.
  int locate(const Vec3& x) const;
};

/// Returns cell coordinates in [-1,1]^3 of a point in grid coordinates (slightly outside for re-homed points).
Vec3 cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& grid_position);

/// Return the position of cell coordinates: in grid coordinates; in global axes, m.
Vec3 grid_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);
Vec3 global_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);

/// Returns the centroid of the material in an active cell, cell coordinates.
Vec3 centroid(const CutCells& cut_cells, int active_cell);

/// Classifies all cells of the grid and integrates the cut ones. Throws InputError if the body has no volume or
/// sticks out of its grid. `face_dividers`: where declared faces end, in grid coordinates: their facets are cut there.
/// `tree`: which cells are refined; Grid::num_levels of the result is its number of levels.
CutCells make_cut_cells(const Solid& solid_in_grid_coordinates, const Grid& grid,
                        const std::vector<Plane>& face_dividers = {}, const GeometryOptions& options = {},
                        const CellTree& tree = {});

/// Adds quadrature points of the facets of the given surfaces in one active cell, cut at the borders of declared faces
/// and at the `dividers` (planes in grid coordinates, e.g. of another body's grid), so that the points of each facet
/// lie on one side of all. On planes its rule integrates polynomials of total degree <= 2 order - 1 exactly, on curved
/// surfaces polynomials in space of total degree <= order + 1 (to about 1e-9); weights are positive. Appends to
/// `points`.
void boundary_points_of_cell(const CutCells& cut_cells, int active_cell, const std::vector<int>& surfaces,
                             const std::vector<Plane>& dividers, int order, BoundaryPoints& points);

}  // namespace cgcontact
