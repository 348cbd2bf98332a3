#include "contact/model/refined_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/memory.hpp"
#include "core/cells/cells_around.hpp"
#include "core/cells/size_field.hpp"

namespace cgcontact {
namespace {

/// Cells are larger than what is wanted if that is less than so much of their size.
constexpr double too_large = 0.999;

/// A divided cell that the body touches leaves at least so many cells more, some of its children being outside.
constexpr double min_added_cells = 2, min_added_cells_in_plane = 1;
/// Memory that a cell takes at least (contact/checks/memory.cpp).
constexpr double min_bytes = 500;

CellTree tree_of_sizes(const BodySpec& body, const BodyGeometry& geometry, const Grid& grid,
                       const std::function<double(const Vec3&, const Vec3&)>& wanted, int levels) {
  const double memory = memory_budget().bytes, max_cells = std::min(body.max_cells, memory / min_bytes);
  try {
    return refine_cells(geometry, grid, wanted, levels,
                        max_cells / (grid.is_quadtree() ? min_added_cells_in_plane : min_added_cells));
  } catch (const TooManyCells&) {
    throw TooManyCells(fmt::format("its smaller cells would be more than {}, too many for {}; ask for larger ones",
                                   grouped(static_cast<long long>(max_cells)),
                                   max_cells < body.max_cells ? memory_text(memory) + " of memory" : "the limit"));
  }
}

/// Halvings that make a cell as small as wanted.
int halvings_for(double cell_size, double wanted) {
  return std::max(0, static_cast<int>(std::ceil(std::log2(cell_size / wanted) - rounding)));
}

/// From a point to a box, a ball or a torus, m; 0 inside.
double distance_to(const RefineSpec& refine, const Vec3& x) {
  const Vec3 from_center = x - refine.center;
  if (refine.kind == RefineSpec::Kind::sphere) return std::max(0.0, from_center.norm() - refine.radius);
  if (refine.kind == RefineSpec::Kind::ring) {
    const double along = from_center.dot(refine.axis), across = (from_center - along * refine.axis).norm();
    return std::max(0.0, std::hypot(across - refine.radius, along) - refine.tube_radius);
  }
  return (x - x.cwiseMax(refine.min).cwiseMin(refine.max)).norm();
}

double wanted_size(const RefineSpec& refine, double distance) {
  return std::max(refine.size, refine.grading * (distance - refine.distance));
}

/// Active cells with points of a face.
std::vector<char> cells_of_face(const CutCells& cells, const FaceSpec& face) {
  std::vector<char> marked(cells.cells.size(), 0);
  const BoundaryPoints& points = cells.boundary;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (face.contains(cells.solid.surfaces()[points.surface[p]].names,
                      cells.grid.to_global(points.position_of_facet(p)),
                      cells.grid.rotation * points.normal_of_facet(p)))
      marked[points.cell[p]] = 1;
  return marked;
}

/// Cells of a level that are to be divided for a face: those of it and those near it.
void add_cells_near_face(const CutCells& cells, const RefineSpec& refine, int level,
                         std::vector<std::vector<Index3>>& refined) {
  const double size = cells.grid.cell_size_of(level);
  // Up to where a cell of this size is too large, in cells.
  const double reach = (size / refine.grading + refine.distance) / size;
  const std::vector<char> of_face = cells_of_face(cells, refine.face);
  std::vector<int> sources;
  for (int e = 0; e < static_cast<int>(of_face.size()); ++e)
    if (of_face[e] && cells.level(e) == level) sources.push_back(e);
  std::vector<char> near(cells.cells.size(), 0);
  constexpr double everywhere = std::numeric_limits<int>::max();
  mark_cells_around(cells, sources, static_cast<int>(std::min(std::ceil(reach - rounding), everywhere)), near);
  for (std::size_t e = 0; e < near.size(); ++e)
    if (near[e] && cells.level(static_cast<int>(e)) == level) refined[level].push_back(cells.cells[e]);
}

}  // namespace

CellTree refined_tree(const BodySpec& body, const Solid& solid, const Grid& grid, const std::vector<Plane>& dividers,
                      const GeometryOptions& options) {
  if (body.refine.empty() && body.sizes.empty()) return {};
  int levels = 1, face_levels = 1;
  for (const RefineSpec& refine : body.refine) {
    const int needed = 1 + halvings_for(grid.cell_size, refine.size);
    (refine.kind == RefineSpec::Kind::face ? face_levels : levels) =
        std::max(refine.kind == RefineSpec::Kind::face ? face_levels : levels, needed);
  }
  for (const auto& field : body.sizes) levels = std::max(levels, 1 + halvings_for(grid.cell_size, field->smallest()));
  const auto wanted = [&](const Vec3& low, const Vec3& high) {
    const Vec3 centre = grid.to_global(0.5 * (low + high));
    Vec3 diagonal = high - low;
    if (grid.is_quadtree()) diagonal[grid.plane_strain] = 0;
    const double radius = 0.5 * grid.cell_size * diagonal.norm();
    double smallest = 1e300;
    for (const RefineSpec& refine : body.refine)
      if (refine.kind != RefineSpec::Kind::face)
        smallest = std::min(smallest, wanted_size(refine, std::max(0.0, distance_to(refine, centre) - radius)));
    const double size = grid.cell_size * (high - low)[0];
    for (const auto& field : body.sizes)
      if (field->asks_below(too_large * size, centre, radius)) smallest = std::min(smallest, size / 2);
    return smallest / grid.cell_size;
  };
  CellTree tree = tree_of_sizes(body, solid.geometry(), grid, wanted, levels);
  // Level by level: where the cells of a face are is known from the cells of the level before.
  for (int level = 0; level + 1 < face_levels; ++level) {
    const CutCells cells = make_cut_cells(solid, grid, dividers, options, tree);
    std::vector<std::vector<Index3>> refined(std::max(level + 1, tree.num_levels() - 1));
    for (int l = 0; l + 1 < tree.num_levels(); ++l)
      tree.refined(l).each([&](const Index3& c) { refined[l].push_back(c); });
    for (const RefineSpec& refine : body.refine)
      if (refine.kind == RefineSpec::Kind::face && halvings_for(grid.cell_size, refine.size) > level)
        add_cells_near_face(cells, refine, level, refined);
    tree = CellTree(grid.num_cells, refined);
  }
  return tree;
}

}  // namespace cgcontact
