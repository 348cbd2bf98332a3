/// The results of a run as values on drawable meshes, shared by the VTK files and the pictures.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/drawing/clip_cells.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Fields at some points; empty vectors where the run has no such field.
struct PointValues {
  std::vector<Vec3> displacement;  ///< m
  std::vector<Sym3> stress;        ///< recovered, Pa
};

/// One body with the fields at the points of its mesh. Those at interior points, of which there are as many as nodes in
/// the volume, are computed where they are needed.
struct DrawnBody : PointValues {
  ClippedMesh mesh;
  std::vector<Vec3> position;  ///< m, undeformed
  /// Values at some interior points of the mesh, ascending. What the fields refer to must still exist.
  std::function<PointValues(const ClippedMesh& mesh, const std::vector<int>& points)> interior;
};

/// m, undeformed.
Vec3 interior_position(const DrawnBody& drawn, std::size_t point);
/// The same of any point of the mesh.
Vec3 position_of(const DrawnBody& drawn, std::size_t point);

/// use(first, values) for all interior points, a block of successive ones at a time, so that their values need little
/// memory.
void each_interior_block(const DrawnBody& drawn, const std::function<void(int first, const PointValues& values)>& use);

/// Returns the volume of the material in an active cell, m^3; on a quadtree for the body's thickness.
double volume_of_cell(const CutCells& cut_cells, int cell);
/// The estimated error of the stress in an active cell: the uniaxial stress of the error's energy, Pa.
double stress_error(const BodyFields& body, int cell);

DrawnBody draw_body(const BodyFields& fields);
std::vector<DrawnBody> draw_bodies(const Results& results);
/// Another mesh of the same body, for example of a region of it.
DrawnBody draw_body(const BodyFields& fields, ClippedMesh mesh);
/// Other fields of the same body, for example those of another step, at the points that it has.
void redraw(const BodyFields& fields, DrawnBody& drawn);

/// Values of the contact rows on the triangles of the contact faces.
struct ContactSurface {
  enum Value { gap, pressure_raw, pressure_spr, pressure_sprc, pressure_error, num_values };
  std::vector<Vec3> position;      ///< m, undeformed
  std::vector<Vec3> displacement;  ///< m
  std::vector<int> point;          ///< of the mesh of the drawn body
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> body, pair, active;  ///< per triangle
  /// Per triangle, of the nearest row: ContactRow::shear_sprc (Pa), slip (m), slips, wear. Without friction zero.
  std::vector<Vec3> shear, slip;
  std::vector<int> slips;
  std::vector<double> wear;  ///< Pa m
  std::vector<int> cell;     ///< per triangle, active cell of the body
  /// Mean of the nearby rows; gap NaN: nothing opposite. The triangle nearest to the largest pressure of a pair has the
  /// values of that row, so that the largest value is that of the report.
  std::vector<std::array<double, num_values>> triangle_values;
  std::vector<std::array<double, num_values>> point_values;  ///< area-weighted mean of the triangles around
  std::size_t size() const { return triangles.size(); }
};

/// The contact faces are the facets of the surface, cell by cell, that hold contact rows.
ContactSurface make_contact_surface(const Results& results, const std::vector<DrawnBody>& bodies);

}  // namespace cgcontact
