/// Which cells a body fills, the moments of the cut ones, and quadrature points on the body's boundary.
/// Everything here is in grid coordinates (cell units, grid axes): h = 1.
#pragma once

#include <vector>

#include "core/cells/boundary_points.hpp"
#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"
#include "core/cells/moments.hpp"
#include "core/geometry/solid.hpp"
#include "core/settings/geometry_options.hpp"

namespace cgcontact {

/// The pieces of a surface in a cell without volume of its own belong to an active neighbour.
struct Adoption {
  int active;    ///< cell that owns the pieces
  Index3 donor;  ///< cell in which they lie (may be outside of the grid by rounding)
  int surface;
};

/// The cells of one body.
struct CutCells {
  Solid solid;  ///< in grid coordinates
  Grid grid;
  std::vector<Index3> cells;         ///< active cells (positive volume), by k, j, i
  GridNumbers numbers;               ///< of the active cells: indices into cells
  std::vector<signed char> levels;   ///< level of each active cell; empty: 0
  std::vector<int> cut_of_active;    ///< index into moments, or -1 for an interior (full) cell
  std::vector<int> active_of_cut;    ///< cut cell -> active cell
  std::vector<Moments> moments;      ///< one per cut cell
  BoundaryPoints boundary;           ///< default rule, all surfaces
  std::vector<Adoption> adoptions;   ///< ascending in active
  std::vector<Plane> face_dividers;  ///< planes at which all boundary pieces are cut (core/scene/face_dividers.hpp)
  long long num_pruned = 0;  ///< cells whose volume was rounding only; their points and moments went to a neighbour

  int level(int active) const { return levels.empty() ? 0 : levels[active]; }
  /// Size of an active cell, m.
  double h(int active) const { return grid.cell_size_of(level(active)); }
  double volume_fraction(int active) const {
    const int cut = cut_of_active[active];
    return cut < 0 ? 1.0 : moments[cut][0] / 8.0;
  }
  /// Active cell at the given cell index triple, or -1.
  int find(const Index3& c) const { return numbers.find(c); }
  /// Active cell that contains the point (grid coordinates), or the nearest active cell within one cell, or -1.
  int locate(const Vec3& x) const;
};

/// Cell coordinates in [-1,1]^3 of a point in grid coordinates (may lie slightly outside for re-homed points).
Vec3 cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& grid_position);

/// Where cell coordinates are: grid coordinates; global axes, m.
Vec3 grid_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);
Vec3 global_position(const CutCells& cut_cells, int active_cell, const Vec3& xi);

/// Classifies all cells of the grid and integrates the cut ones. Throws InputError if the body has no volume or
/// sticks out of its grid. `face_dividers`: where declared faces end, in grid coordinates: their pieces are cut there.
CutCells make_cut_cells(const Solid& solid_in_grid_coordinates, const Grid& grid,
                        const std::vector<Plane>& face_dividers = {}, const GeometryOptions& options = {});

/// Quadrature points of the pieces of the given surfaces in one active cell, the pieces being split at the
/// borders of declared faces and additionally at the `dividers` (planes in grid coordinates, e.g. the grid planes of
/// another body's grid) so that the points of every part lie on one side of each. On planes the rule of every part
/// integrates polynomials of total degree
/// <= 2 order - 1 exactly, on curved surfaces polynomials in space of total degree <= order + 1 (to about 1e-9);
/// weights are positive. Appends to `points`.
void boundary_points_of_cell(const CutCells& cut_cells, int active_cell, const std::vector<int>& surfaces,
                             const std::vector<Plane>& dividers, int order, BoundaryPoints& points);

}  // namespace cgcontact
