#include "contact/adaptive/first_grid.hpp"

#include <cmath>

#include "contact/model/model.hpp"

namespace cgcontact {
namespace {

/// Cells along the longest side of the grid on which volume and surface are measured: both are exact on any.
constexpr double measuring_cells = 8;

}  // namespace

double first_cell_size(const BodySpec& body, const GeometryOptions& geometry, const AccuracyOptions& options) {
  BodySpec measured = body;
  Vec3 min, max;
  measured.cell_size = 1;
  if (measured.solid.bounding_box(min, max)) measured.cell_size = (max - min).maxCoeff() / measuring_cells;
  const Grid grid = make_grid(measured);
  CutCells cells;
  try {
    cells = make_cut_cells(
        body.solid.transformed(grid.rotation.transpose(), -(grid.rotation.transpose() * grid.origin) / grid.cell_size,
                               1.0 / grid.cell_size),
        grid, {}, geometry);
  } catch (const InputError& error) {
    throw InputError(body.place, "\"" + body.name + "\"", error.what());
  }
  double area = 0;
  for (const double weight : cells.boundary.weight) area += weight;
  const double thickness = 2 * volume(cells) / area;
  const double through = thickness / options.first_cells_through;
  const double affordable = std::cbrt(volume(cells) / options.most_first_cells);
  return grid.cell_size * std::max(through, affordable);
}

}  // namespace cgcontact
