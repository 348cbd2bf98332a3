/// Drawable mesh of a body's cut cells: hexahedra for full cells, tetrahedra where the boundary passes, and the
/// triangles of the boundary. For output only; integration uses the moments.
#pragma once

#include <array>
#include <vector>

#include "core/cells/cut_cells.hpp"

namespace cgcontact {

/// Triangle of the body's boundary, counterclockwise seen from outside.
struct BoundaryTriangle {
  std::array<int, 3> points;
  int cell;       ///< active cell
  int surface;    ///< index into the surfaces of the clipped solid
  int level = 0;  ///< of the cell
};

/// Six tetrahedra around the diagonal 0-6 of a hexahedron: one for each order in which the axes can be walked.
constexpr int tetrahedra_of_hexahedron[6][4] = {{0, 1, 2, 6}, {0, 1, 5, 6}, {0, 3, 2, 6},
                                                {0, 3, 7, 6}, {0, 4, 5, 6}, {0, 4, 7, 6}};

/// Full cells that no surface comes near: hexahedra, kept as numbers only. Points of theirs that no polyhedron has are
/// interior points, numbered behind those of the mesh.
struct InteriorCells {
  std::vector<int> cells;                    ///< active cells, ascending
  std::vector<int> cell_of_point;            ///< of each interior point, one that has it as a corner
  std::vector<signed char> corner_of_point;  ///< which: bits x, y, z
  struct Nodes {
    GridNumbers numbers;     ///< corners of the cells of a level
    std::vector<int> point;  ///< of each: point of the mesh, or -2 - interior point; -1: none
  };
  std::vector<Nodes> levels;
};

/// Points are shared between the cells that touch them, so that fields that are continuous in the body stay so. What is
/// stored by polyhedron grows like the boundary; the interior is made from its cells where it is needed.
struct ClippedMesh {
  std::vector<Vec3> points;                    ///< grid coordinates
  std::vector<int> cell_of_point;              ///< an active cell whose closure contains the point
  std::vector<std::array<int, 8>> hexahedra;   ///< VTK order: bottom square, then top square
  std::vector<int> cell_of_hexahedron;         ///< active cell
  std::vector<std::array<int, 4>> tetrahedra;  ///< positively oriented
  std::vector<int> cell_of_tetrahedron;        ///< active cell
  std::vector<BoundaryTriangle> boundary;
  std::vector<signed char> level_of_cell;  ///< of each active cell; empty: 0
  const CutCells* cut_cells = nullptr;     ///< of the body, which the interior needs; nullptr: no interior
  InteriorCells interior;

  int level(int cell) const { return level_of_cell.empty() ? 0 : level_of_cell[cell]; }
  std::size_t num_interior_points() const { return interior.cell_of_point.size(); }
  /// Counts the interior ones too.
  std::size_t num_points() const { return points.size() + num_interior_points(); }
  /// Counts hexahedra, tetrahedra and interior cells, in this order.
  std::size_t num_polyhedra() const { return hexahedra.size() + tetrahedra.size() + interior.cells.size(); }
  struct Polyhedron {
    std::array<int, 8> points;
    int num_points;  ///< 8: a hexahedron, VTK order; 4: a tetrahedron
    int cell;        ///< active cell
  };
  Polyhedron polyhedron(std::size_t i) const;
  /// Return an interior point in its cell's coordinates; in grid coordinates.
  Vec3 interior_xi(std::size_t point) const;
  Vec3 interior_point(std::size_t point) const;
  /// Returns the corners of interior.cells[i], VTK order; interior points are numbered from points.size() on.
  std::array<int, 8> interior_hexahedron(std::size_t i) const;
  double volume() const;         ///< in cell units cubed
  double boundary_area() const;  ///< in cell units squared
};

/// Clips the active cells to tetrahedra. Corner cases, decided here:
/// - A cut cell is divided into the six tetrahedra around its main diagonal, the same in all cells, so that neighbours
///   agree on their common face. Where a curved surface passes, the cell is first divided into m^3 cubes, m chosen from
///   the curvature for the whole body.
/// - A tetrahedron is cut by one surface after the other, by bisecting its edges that change side, in the order of
///   their positions: neighbours bisect a common face in the same order, so there are no cracks, and ranges of cells
///   can be clipped side by side.
/// - A vertex closer to a surface than 1e-10 lies on it and never causes a cut. A tetrahedron whose vertices all lie on
/// a
///   surface is on the side of its centroid. Tetrahedra of no volume are dropped, cells filled to less than 1e-10 with
///   them.
/// - The boundary of a body of triangles is those triangles, divided along the grid planes. Its tetrahedra end where
/// the
///   distances to the planes of the nearest triangles of the patches are zero: close to the boundary, exact at flat
///   faces.
/// - Surfaces that only bulge into an edge or face without passing between two vertices are not seen: the mesh of a
///   curved body is second-order accurate, that of a planar one exact.
ClippedMesh clip_cells(const CutCells& cut_cells);

/// Clips the boundary alone: the same without cells where they are not needed to find it.
ClippedMesh clip_boundary(const CutCells& cut_cells);

/// Returns cell coordinates in [-1,1]^3 of a point (grid coordinates) in an active cell; clamped to the cell.
Vec3 clamped_cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& point);

}  // namespace cgcontact
