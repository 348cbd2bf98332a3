#include "core/drawing/drawn_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/base/process/parallel.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {

namespace {

using FacetRows = std::map<std::pair<int, int>, std::vector<const ContactRow*>>;

/// The elementary surface a row lies on.
int surface_of_row(const CutCells& cut_cells, const ContactRow& row) {
  return cut_cells.solid.surface_at(cut_cells.grid.to_grid(row.x), cut_cells.grid.rotation.transpose() * row.normal);
}

/// Rows of one body by active cell and surface.
FacetRows rows_by_facet(const Results& results, int body) {
  FacetRows facets;
  const CutCells& cut_cells = *results.bodies[body].cut_cells;
  for (const ContactRow& row : results.contact_rows)
    if (row.body == body) facets[{row.cell, surface_of_row(cut_cells, row)}].push_back(&row);
  return facets;
}

/// Appends a triangle with the inverse-distance mean of the rows; the gap is NaN where no row has anything opposite.
void add_triangle(const Vec3& centroid, double spacing, const std::vector<const ContactRow*>& rows,
                  ContactSurface& surface) {
  std::array<double, ContactSurface::num_values> sum{};
  double total = 0, total_of_gap = 0, nearest = std::numeric_limits<double>::max();
  const ContactRow* nearest_row = rows.front();
  for (const ContactRow* row : rows) {
    const double distance = (row->x - centroid).squaredNorm();
    const double weight = 1 / (distance + 1e-4 * spacing * spacing);
    if (std::isfinite(row->gap)) {
      sum[ContactSurface::gap] += weight * row->gap;
      total_of_gap += weight;
    }
    sum[ContactSurface::pressure_raw] += weight * row->pressure_raw;
    sum[ContactSurface::pressure_spr] += weight * row->pressure_spr;
    sum[ContactSurface::pressure_sprc] += weight * row->pressure_sprc;
    sum[ContactSurface::pressure_error] += weight * row->pressure_error;
    total += weight;
    if (distance < nearest) {
      nearest = distance;
      nearest_row = row;
    }
  }
  for (int k = 0; k < ContactSurface::num_values; ++k) sum[k] /= k == ContactSurface::gap ? total_of_gap : total;
  surface.triangle_values.push_back(sum);
  surface.body.push_back(nearest_row->body);
  surface.pair.push_back(nearest_row->pair);
  surface.active.push_back(nearest_row->active);
  surface.shear.push_back(nearest_row->shear_sprc);
  surface.slip.push_back(nearest_row->slip);
  surface.slips.push_back(nearest_row->slips);
  surface.wear.push_back(nearest_row->wear);
}

/// Facets that hold rows but no triangle: slivers too thin to draw, whose face appears on a neighbouring cell.
FacetRows undrawn_facets(const DrawnBody& drawn, FacetRows facets) {
  for (const BoundaryTriangle& triangle : drawn.mesh.boundary) facets.erase({triangle.cell, triangle.surface});
  return facets;
}

/// Rows of the triangle's cell and surface, or of an undrawn neighbour; nullptr if it is not on a contact face.
const std::vector<const ContactRow*>* rows_of_triangle(const CutCells& cut_cells, const BoundaryTriangle& triangle,
                                                       const FacetRows& facets, const FacetRows& undrawn) {
  const auto own = facets.find({triangle.cell, triangle.surface});
  if (own != facets.end()) return &own->second;
  if (undrawn.empty()) return nullptr;
  const std::vector<const ContactRow*>* found = nullptr;
  each_cell_beside(cut_cells, triangle.cell, [&](int neighbour) {
    const auto rows = undrawn.find({neighbour, triangle.surface});
    if (!found && rows != undrawn.end()) found = &rows->second;
  });
  return found;
}

void add_body(const DrawnBody& drawn, const CutCells& cut_cells, const FacetRows& facets, ContactSurface& surface) {
  const FacetRows undrawn = undrawn_facets(drawn, facets);
  std::vector<int> number(drawn.position.size(), -1);
  for (const BoundaryTriangle& triangle : drawn.mesh.boundary) {
    const auto* rows = rows_of_triangle(cut_cells, triangle, facets, undrawn);
    if (!rows) continue;
    std::array<int, 3> points;
    Vec3 centroid = Vec3::Zero();
    for (int v = 0; v < 3; ++v) {
      const int p = triangle.points[v];
      if (number[p] < 0) {
        number[p] = static_cast<int>(surface.position.size());
        surface.position.push_back(drawn.position[p]);
        surface.point.push_back(p);
        if (!drawn.displacement.empty()) surface.displacement.push_back(drawn.displacement[p]);
      }
      points[v] = number[p];
      centroid += drawn.position[p] / 3;
    }
    surface.triangles.push_back(points);
    surface.cell.push_back(triangle.cell);
    add_triangle(centroid, cut_cells.grid.cell_size, *rows, surface);
  }
}

/// The row in which the pair's pressure is largest, or nullptr.
const ContactRow* largest_row(const Results& results, int pair) {
  const PairFigures& figures = results.pairs[pair];
  const ContactRow* found = nullptr;
  for (const ContactRow& row : results.contact_rows)
    if (row.pair == pair && row.pressure_sprc == figures.max_pressure &&
        (!found ||
         (row.x - figures.max_pressure_at).squaredNorm() < (found->x - figures.max_pressure_at).squaredNorm()))
      found = &row;
  return found;
}

/// Means are below the largest pressure of a pair: the triangle nearest to it gets it.
void assign_largest_pressures(const Results& results, ContactSurface& surface) {
  for (int pair = 0; pair < static_cast<int>(results.pairs.size()); ++pair) {
    const ContactRow* const row = largest_row(results, pair);
    if (!row || !(row->pressure_sprc > 0)) continue;
    std::size_t nearest = surface.size();
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (surface.pair[i] != pair || surface.body[i] != row->body) continue;
      const auto& t = surface.triangles[i];
      const Vec3 centroid = (surface.position[t[0]] + surface.position[t[1]] + surface.position[t[2]]) / 3;
      if (const double distance = (centroid - row->x).squaredNorm(); distance < least) {
        least = distance;
        nearest = i;
      }
    }
    if (nearest == surface.size()) continue;
    surface.triangle_values[nearest] = {std::isfinite(row->gap) ? row->gap : std::nan(""), row->pressure_raw,
                                        row->pressure_spr, row->pressure_sprc, row->pressure_error};
    surface.active[nearest] = row->active;
  }
}

/// Area-weighted mean of the triangles around each point; of the gap, those that have one, NaN if none has.
void average_to_points(ContactSurface& surface) {
  using Values = std::array<double, ContactSurface::num_values>;
  surface.point_values.assign(surface.position.size(), Values{});
  std::vector<Values> total(surface.position.size(), Values{});
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const auto& t = surface.triangles[i];
    const Vec3& a = surface.position[t[0]];
    const double area = (surface.position[t[1]] - a).cross(surface.position[t[2]] - a).norm();
    for (int p : t)
      for (int k = 0; k < ContactSurface::num_values; ++k) {
        if (!std::isfinite(surface.triangle_values[i][k])) continue;
        total[p][k] += area;
        surface.point_values[p][k] += area * surface.triangle_values[i][k];
      }
  }
  for (std::size_t p = 0; p < total.size(); ++p)
    for (int k = 0; k < ContactSurface::num_values; ++k)
      if (total[p][k] > 0 || k == ContactSurface::gap) surface.point_values[p][k] /= total[p][k];
}

}  // namespace

double volume_of_cell(const CutCells& cut_cells, int cell) {
  const Grid& grid = cut_cells.grid;
  const double h = cut_cells.h(cell);
  const double thickness = grid.is_axisymmetric() ? 2 * pi * cut_cells.radius(cell)
                           : grid.is_quadtree()   ? grid.thickness
                                                  : h;
  return cut_cells.volume_fraction(cell) * h * h * thickness;
}

double stress_error(const BodyFields& body, int cell) {
  if (body.rigid) return 0;
  return body.error_of_cell[cell] * std::sqrt(body.material.youngs_modulus / volume_of_cell(*body.cut_cells, cell));
}

namespace {

/// Radii: the thickness of the sections of bodies of revolution as they are drawn.
constexpr double drawn_thickness = 0.02;

/// Interior points whose values are in memory at a time: 5 MB.
constexpr std::size_t points_per_block = 1 << 16;

/// cell_position(i): active cell and cell coordinates of the i-th of n points.
template <class PositionOf>
PointValues values_at(const std::function<Vec3(int cell, const Vec3& xi)>& displacement,
                      const std::function<Sym3(int cell, const Vec3& xi)>& stress, std::size_t n,
                      const PositionOf& cell_position) {
  PointValues values;
  if (displacement) values.displacement.resize(n);
  if (stress) values.stress.resize(n);
  if (displacement || stress)
    parallel_for("cgcontact::drawn_body::fields", n, grain_of_medium, [&](std::size_t i) {
      const auto [cell, xi] = cell_position(i);
      if (displacement) values.displacement[i] = displacement(cell, xi);
      if (stress) values.stress[i] = stress(cell, xi);
    });
  return values;
}

}  // namespace

Vec3 interior_position(const DrawnBody& drawn, std::size_t point) {
  return drawn.mesh.cut_cells->grid.to_global(drawn.mesh.interior_point(point));
}

Vec3 position_of(const DrawnBody& drawn, std::size_t point) {
  const std::size_t boundary = drawn.position.size();
  return point < boundary ? drawn.position[point] : interior_position(drawn, point - boundary);
}

void each_interior_block(const DrawnBody& drawn, const std::function<void(int first, const PointValues& values)>& use) {
  const std::size_t n = drawn.mesh.num_interior_points();
  for (std::size_t first = 0; first < n; first += points_per_block) {
    std::vector<int> block(std::min(points_per_block, n - first));
    std::iota(block.begin(), block.end(), static_cast<int>(first));
    use(block.front(), drawn.interior(drawn.mesh, block));
  }
}

void redraw(const BodyFields& fields, DrawnBody& drawn) {
  const CutCells& cut_cells = *fields.cut_cells;
  const std::size_t n = drawn.mesh.points.size();
  const auto cell_position_of = [&](std::size_t p) {
    const int cell = drawn.mesh.cell_of_point[p];
    return std::make_pair(cell, clamped_cell_coordinates(cut_cells, cell, drawn.mesh.points[p]));
  };
  drawn.position.resize(n);
  parallel_for("cgcontact::drawn_body::positions", n, grain_of_medium, [&](std::size_t p) {
    drawn.position[p] = cut_cells.grid.to_global(drawn.mesh.points[p]);
    if (const Grid& grid = cut_cells.grid; grid.is_quadtree())  // not the slice, but the body
      drawn.position[p][grid.plane_strain] +=
          0.5 * (grid.is_axisymmetric() ? drawn_thickness * grid.unit_radius : grid.thickness) *
          cell_position_of(p).second[grid.plane_strain];
  });
  static_cast<PointValues&>(drawn) = values_at(fields.displacement, fields.stress_recovered, n, cell_position_of);
  drawn.interior = [displacement = fields.displacement, stress = fields.stress_recovered,
                    stress_at_corners = fields.stress_at_corners](const ClippedMesh& mesh,
                                                                  const std::vector<int>& points) {
    const bool by_corners = stress && stress_at_corners;
    PointValues values =
        values_at(displacement, by_corners ? decltype(stress)() : stress, points.size(), [&](std::size_t i) {
          const auto point = static_cast<std::size_t>(points[i]);
          return std::make_pair(mesh.interior.cell_of_point[point], mesh.interior_xi(point));
        });
    if (!by_corners) return values;
    std::vector<int> cells;
    std::vector<signed char> corners;
    for (const int point : points) {
      cells.push_back(mesh.interior.cell_of_point[point]);
      corners.push_back(mesh.interior.corner_of_point[point]);
    }
    values.stress = stress_at_corners(cells, corners);
    return values;
  };
}

DrawnBody draw_body(const BodyFields& fields, ClippedMesh mesh) {
  DrawnBody drawn;
  drawn.mesh = std::move(mesh);
  redraw(fields, drawn);
  return drawn;
}

DrawnBody draw_body(const BodyFields& fields) { return draw_body(fields, clip_cells(*fields.cut_cells)); }

std::vector<DrawnBody> draw_bodies(const Results& results) {
  std::vector<DrawnBody> drawn;
  for (const BodyFields& fields : results.bodies) drawn.push_back(draw_body(fields));
  return drawn;
}

ContactSurface make_contact_surface(const Results& results, const std::vector<DrawnBody>& bodies) {
  ContactSurface surface;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const FacetRows facets = rows_by_facet(results, static_cast<int>(b));
    if (!facets.empty()) add_body(bodies[b], *results.bodies[b].cut_cells, facets, surface);
  }
  average_to_points(surface);
  assign_largest_pressures(results, surface);
  return surface;
}

}  // namespace cgcontact
