/// Facets of a triangle surface: its triangles clipped to cells, and quadrature points on them. Grid coordinates.
/// Corner cases, decided here:
/// - Cells are cut out axis by axis. An intersection with a grid plane gets its coordinate exactly and is computed from
///   the end of the edge below the plane to the one above, so that triangles with a common edge agree on it.
/// - A facet that lies in a grid plane up to 1e-12 cells belongs to the cell on its inner side: no slivers of rounding.
/// - A polygon is cut along one chord into two polygons whose areas add up to its own, whatever rounding does to the
///   corners. So every point of the surface lies in exactly one cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/cad/curved_triangles.hpp"
#include "core/cells/boundary_points.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

/// Convex polygon in space, counterclockwise seen from outside the body.
struct SurfacePolygon {
  static constexpr int max_corners = 64;
  int n = 0;
  std::array<Vec3, max_corners> x;

  SurfacePolygon() = default;
  SurfacePolygon(const SurfacePolygon& other) { *this = other; }
  /// Copies the corners that there are.
  SurfacePolygon& operator=(const SurfacePolygon& other) {
    n = other.n;
    std::copy_n(other.x.begin(), n, x.begin());
    return *this;
  }
  void push(const Vec3& corner);
};

/// Returns the whole triangle.
SurfacePolygon triangle_polygon(const TriangleSurface& surface, int triangle);

/// Splits at x[axis] = value into the polygons below and above; one is empty unless corners lie strictly on both sides.
void split_at(const SurfacePolygon& polygon, int axis, double value, SurfacePolygon& below, SurfacePolygon& above);

/// Clips a triangle to a cell; no corners if nothing is left.
SurfacePolygon clipped_to_cell(const TriangleSurface& surface, int triangle, const Index3& cell);

/// Calls use(cell, polygon) for all cells that hold a facet of the triangle.
template <class Use>
void each_cell_of_triangle(const TriangleSurface& surface, int triangle, const Use& use);
/// The same for the cells that are wanted: next(axis, cell) is the first index from cell[axis] on, along z of all,
/// along y of those in the layer cell[2], along x of those in the row cell[1], cell[2].
template <class Next, class Use>
void each_cell_of_triangle(const TriangleSurface& surface, int triangle, const Next& next, const Use& use);

/// Degrees that a rule on a triangle with a bent rim has more than one on a straight one.
constexpr int bend_degrees = 4;

/// Adds the points of the given triangles, as cell_boundary_points (core/bodies/cell_facets.hpp). The facets of a patch
/// in a cell are grouped by plane: up to 8 planes get the full rule on each, up to 32 one of degree 2 (in cells with
/// more than 32 and 128 planes of all patches one degree less). With more planes a patch gets at most 29 points on each
/// side of the dividers: forces and moments stay exact, integrals of polynomials those of its facets (of degree 3 along
/// the surface, second moments). `curved`: what the triangles stand for; points and normals are then those of the exact
/// surface, as on the quadrics of CSG bodies.
void triangle_boundary_points(const TriangleSurface& surface, const CurvedTriangles* curved,
                              const std::vector<int>& triangles, const Index3& cell, const std::vector<char>& selected,
                              const std::vector<Plane>& dividers, int order, int owner, BoundaryPoints& points);

/// Point on a triangle of a facet: the weights of its corners 1 and 2, and how much of the triangle it stands for (the
/// whole one: 1/2).
struct TrianglePoint {
  double a, b, weight;
};
/// Adds the points of a rule on a facet, exact for polynomials of the degree on the flat triangle.
void add_clipped_rule(const TriangleSurface& surface, int triangle, const SurfacePolygon& polygon, int degree,
                      std::vector<TrianglePoint>& points);

/// Returns the triangles that may have a facet in a cell, ascending.
std::vector<int> triangles_near_cell(const TriangleSurface& surface, const Index3& cell);

namespace clipped_triangles {

/// Returns the range of cells along an axis that hold a polygon.
std::pair<int, int> cell_range(const SurfacePolygon& polygon, int axis, double normal);

/// next(axis, cell): the first index from cell[axis] on that is wanted, of the cells with these indices along the later
/// axes.
template <class Next, class Use>
void split_into_cells(const SurfacePolygon& polygon, int axis, const Vec3& normal, Index3& cell, const Next& next,
                      const Use& use) {
  const auto [first, last] = cell_range(polygon, axis, normal[axis]);
  SurfacePolygon rest = polygon, below, above;
  int reached = cell[axis] = first;  // where the rest begins
  for (; (cell[axis] = next(axis, cell)) <= last; reached = ++cell[axis]) {
    if (cell[axis] > reached) {
      split_at(rest, axis, cell[axis], below, above);
      rest = above;
      if (rest.n == 0) return;
    }
    const bool is_last = cell[axis] == last;
    if (!is_last) split_at(rest, axis, cell[axis] + 1, below, above);
    const SurfacePolygon& within = is_last ? rest : below;
    if (axis > 0)
      split_into_cells(within, axis - 1, normal, cell, next, use);
    else
      use(static_cast<const Index3&>(cell), within);
    if (!is_last) rest = above;
  }
}

}  // namespace clipped_triangles

template <class Next, class Use>
void each_cell_of_triangle(const TriangleSurface& surface, int triangle, const Next& next, const Use& use) {
  Index3 cell{0, 0, 0};
  clipped_triangles::split_into_cells(triangle_polygon(surface, triangle), 2, surface.normal(triangle), cell, next,
                                      use);
}

template <class Use>
void each_cell_of_triangle(const TriangleSurface& surface, int triangle, const Use& use) {
  each_cell_of_triangle(
      surface, triangle, [](int axis, const Index3& cell) { return cell[axis]; }, use);
}

}  // namespace cgcontact
