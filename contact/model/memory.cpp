#include "contact/model/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/memory.hpp"
#include "core/cells/cell_classification.hpp"

namespace cgcontact {
namespace {

/// Cells of the coarse grid from which sizes are estimated, and of the finer one where the first estimate is near what
/// there is: a second or two, and the sizes within some 3 %, most of them below 1 %.
constexpr double coarse_cells = 1 << 17, finer_cells = 1 << 25;
/// So near, as a factor.
constexpr double near_limit = 1.4;
/// Of the available memory, for the cell size that is advised: sizes scale with the cells to so much.
constexpr double safe_part = 0.8;

double num_cells(const Grid& grid) {
  return static_cast<double>(grid.num_cells[0]) * grid.num_cells[1] * grid.num_cells[2];
}

/// A plane of area A with the unit normal n crosses A (|nx| + |ny| + |nz|) / h^2 cells (axes of the grid).
BodySize size_of_triangles(const TriangleSurface& surface, const Grid& grid) {
  const double h = grid.cell_size;
  double crossed = 0, volume = 0;
  const Vec3 origin = surface.corner(0, 0);
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const Vec3 a = surface.corner(t, 0) - origin, b = surface.corner(t, 1) - origin, c = surface.corner(t, 2) - origin;
    crossed += (grid.rotation.transpose() * (b - a).cross(c - a)).lpNorm<1>() / 2;
    volume += a.dot(b.cross(c)) / 6;
  }
  const double cut = crossed / (h * h);
  return {volume / (h * h * h) + cut, cut, static_cast<double>(surface.triangles().size())};
}

/// Some point near its corners, the middles of its sides or its centre is inside, some outside: a surface does more
/// than touch it. With none inside, a coarse cell counts as empty, with all inside as full: a face that lies on its
/// side cuts a layer.
int inside_of(const Solid& solid, const Index3& cell) {
  constexpr double place[3] = {0.01, 0.5, 0.99};
  int inside = 0;
  for (int n = 0; n < 27; ++n)
    inside += solid.contains(Vec3(cell[0] + place[n % 3], cell[1] + place[n / 3 % 3], cell[2] + place[n / 9]));
  return inside;
}

/// Cells of a coarse cell that a surface crosses have the two longest of its three extents; of a plate of one or two
/// cells all are cut. Half of the cells of a coarse cell are in the body. Beside a cut cell half a layer of nodes comes
/// on top of one node by cell.
BodySize size_of_coarse_cells(const BodySpec& body, const Grid& grid, double most_cells) {
  int factor = 1;
  while (num_cells(grid) / std::pow(factor, 3) > most_cells) ++factor;
  Grid coarse = grid;
  coarse.cell_size *= factor;
  for (int& n : coarse.num_cells) n = (n + factor - 1) / factor;
  const Solid solid =
      body.solid.transformed(coarse.rotation.transpose(),
                             -(coarse.rotation.transpose() * coarse.origin) / coarse.cell_size, 1 / coarse.cell_size);
  const CellClasses classes = classify_cells(solid, coarse);
  BodySize size{static_cast<double>(classes.inside.size()) * std::pow(factor, 3), 0};
  const bool is_thin = *std::min_element(grid.num_cells.begin(), grid.num_cells.end()) <= 3;
  for (const Index3& c : classes.candidates) {
    double extent[3];
    for (int k = 0; k < 3; ++k) extent[k] = c[k] < 0 ? 0 : std::clamp(grid.num_cells[k] - c[k] * factor, 0, factor);
    const double all = extent[0] * extent[1] * extent[2];
    const int inside_points = inside_of(solid, c);
    if (inside_points == 0) continue;
    const double across = std::min({extent[0], extent[1], extent[2]});
    const double cut = is_thin ? all : all / across;
    size.cut_cells += cut;
    size.nodes += inside_points == 27 ? all : std::max(cut, all / 2);
  }
  size.nodes += size.cut_cells / 2;
  return size;
}

/// The same bodies with all cells larger by a factor.
std::vector<BodySize> coarsened(std::vector<BodySize> bodies, double factor) {
  for (BodySize& size : bodies) {
    size.nodes /= std::pow(factor, 3);
    size.cut_cells /= std::pow(factor, 2);
  }
  return bodies;
}

/// Empty if no cells are large enough.
std::string fitting_cells(const Scene& scene, const std::vector<BodySize>& bodies, const MemoryExtras& extras,
                          double available) {
  double factor = 1;
  const auto needed = [&] {
    const double surface = factor * factor;
    return expected_memory(coarsened(bodies, factor),
                           {extras.contact_points / surface, extras.contact_rows / surface, extras.pictures});
  };
  while (factor < 1e4 && needed() > safe_part * available) factor *= 1.02;
  if (factor >= 1e4) return {};
  factor = std::ceil(10 * factor) / 10;
  std::string text = fmt::format("cells larger by {:.1f} would fit:", factor);
  for (const BodySpec& body : scene.bodies)
    text += fmt::format("{} {:.2g} m for \"{}\"", &body == scene.bodies.data() ? "" : ",", body.cell_size * factor,
                        body.name);
  return text;
}

}  // namespace

BodySize estimate_size(const BodySpec& body, bool finer) {
  const Grid grid = make_grid(body);
  return body.solid.triangles() ? size_of_triangles(*body.solid.triangles(), grid)
                                : size_of_coarse_cells(body, grid, finer ? finer_cells : coarse_cells);
}

BodySize size_of(const CutCells& cc) {
  return {static_cast<double>(cc.numbers.corners().size()), static_cast<double>(cc.moments.size()),
          cc.solid.triangles() ? static_cast<double>(cc.solid.triangles()->triangles().size()) : 0.0};
}

/// Fitted to runs of the scenes of this repository (docs/faq.md, "Time and memory"). What grows like the surface weighs
/// most. Cells of the grid that are empty cost nothing.
double expected_memory(const std::vector<BodySize>& bodies, const MemoryExtras& extras) {
  double bytes = 85e6 + (extras.pictures ? 25e6 : 0) + 900 * extras.contact_points + 500 * extras.contact_rows;
  for (const BodySize& body : bodies)
    bytes += dofs_per_node * 170.0 * body.nodes + 11.5e3 * body.cut_cells + 1.1e3 * body.triangles;
  return bytes;
}

void check_memory_early(const Scene& scene, bool near_limit_too) {
  const double available = memory_budget().bytes;
  for (const bool finer : {false, true}) {
    std::vector<BodySize> sizes;
    for (const BodySpec& body : scene.bodies) sizes.push_back(estimate_size(body, finer));
    const double expected = expected_memory(sizes, {0, 0, scene.output.plots});
    if (expected * near_limit < available) return;
    if (expected > near_limit * available || finer) check_memory(scene, sizes, {0, 0, scene.output.plots});
    if (!near_limit_too) return;
  }
}

void check_memory(const Scene& scene, const std::vector<BodySize>& bodies, const MemoryExtras& extras) {
  const MemoryBudget budget = memory_budget();
  const double expected = expected_memory(bodies, extras);
  if (expected <= budget.bytes) return;
  const std::string fitting = fitting_cells(scene, bodies, extras, budget.bytes);
  throw InputError(
      fmt::format("{}: needs about {} of memory, and there are {} ({}); {}; {}--memory-limit overrides this",
                  scene.file, memory_text(expected), memory_text(budget.bytes), budget.source,
                  fitting.empty() ? "no cell size fits, the program itself needs some 85 MB" : fitting,
                  budget.remedy.empty() ? "" : budget.remedy + "; "));
}

}  // namespace cgcontact
