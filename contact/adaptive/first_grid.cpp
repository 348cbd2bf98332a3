#include "contact/adaptive/first_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/model/model.hpp"

namespace cgcontact {
namespace {

/// Cells along the longest side of the grid on which volume and surface are measured: both are exact on any.
constexpr double measuring_cells = 8;

/// Along the axes of its grid, m; across a quadtree 0 or infinite: any thickness.
Vec3 extent(const BodySpec& body, double across) {
  Vec3 min, max;
  if (!body.solid.transformed(body.grid_rotation.transpose(), Vec3::Zero()).bounding_box(min, max))
    throw InputError(body.location, "\"" + body.name + "\"", "the body is not bounded",
                     "intersect half-spaces with a box");
  Vec3 extent = max - min;
  if (body.quadtree) extent[static_cast<int>(*body.plane_strain)] = across;
  return extent;
}

/// Returns the size of cells (grid coordinates) of which `count` fill the body.
double size_of_cells(const BodyModel& body, double count) {
  const Grid& grid = body.cut_cells.grid;
  const double filled = volume(body.cut_cells);
  return grid.is_quadtree() ? std::sqrt(filled / grid.thickness_of_cell(0) / count) : std::cbrt(filled / count);
}

}  // namespace

std::vector<double> first_cell_sizes(const Scene& scene) {
  const AccuracyOptions& options = scene.accuracy;
  std::vector<double> sizes;
  Scene measured = scene;
  for (BodySpec& body : measured.bodies) {
    sizes.push_back(body.cell_size);
    body.cell_size = extent(body, 0).maxCoeff() / measuring_cells;
    body.refine.clear();
  }
  if (std::all_of(sizes.begin(), sizes.end(), [](double size) { return size > 0; })) return sizes;
  const std::vector<BodyModel> models = make_body_models(measured);
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    if (sizes[b] > 0) continue;
    const double through = models[b].free_thickness / options.first_cells_through;
    const double affordable = size_of_cells(models[b], options.max_first_cells);
    const double size = measured.bodies[b].cell_size * std::max(through, affordable);
    sizes[b] = std::min(size, extent(measured.bodies[b], std::numeric_limits<double>::infinity()).minCoeff());
  }
  return sizes;
}

}  // namespace cgcontact
