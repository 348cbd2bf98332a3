#include "contact/checks/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/model/plane_strain.hpp"
#include "core/base/process/memory.hpp"
#include "core/cad/cad_model.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {
namespace {

/// Cells of the coarse grid from which sizes are estimated, and of the finer one where that is near the limit: a second
/// or two, sizes within some 3 %, most below 1 %.
constexpr double coarse_cells = 1 << 17, finer_cells = 1 << 25;
/// So near, as a factor; by less than it runs exceed their forecasts too (docs/faq.md, "Time and memory").
constexpr double near_limit = 1.4;
/// Fraction of the available memory for which a cell size is advised: sizes scale with the cells to that.
constexpr double safe_fraction = 0.8;

/// Bytes. Debian's Trilinos brings 38 shared libraries more than `make trilinos-openmp` builds; the large pages that
/// the program with OpenMP asks for take 1 to 4 MB more in small scenes.
double program_itself() { return TrilinosScope::has_openmp() ? 90e6 : 100e6; }

/// Bytes that two threads take more than one while fields and pictures are made: 20 MB with 2,016 cut cells, 39 MB with
/// 4,632, no more with 60,000.
double beside_pictures(const std::vector<BodySize>& bodies) {
  double cut_cells = 0;
  for (const BodySize& body : bodies) cut_cells += body.cut_cells;
  return std::min(5e6 + 7.3e3 * cut_cells, 39e6);
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
    MemoryExtras of_these = extras;
    if (of_these.points)
      for (double* number : {&of_these.points->contact, &of_these.points->support, &of_these.points->rows})
        *number /= factor * factor;
    return expected_memory(coarsened(bodies, factor), of_these);
  };
  while (factor < 1e4 && needed() > safe_fraction * available) factor *= 1.02;
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
  Solid solid = body.solid;
  if (body.quadtree) {  // in one layer of cells
    const double low = grid.origin[grid.plane_strain];
    solid = stretched_to(body, solid, low, low + grid.cell_size);
  }
  const BodyGeometry& geometry = solid.geometry();
  const CellEstimate estimate = geometry.estimate_cells(grid, finer ? finer_cells : coarse_cells);
  return {estimate.nodes, estimate.cut_cells, static_cast<double>(geometry.num_facets()),
          body.plane_strain.has_value()};
}

BodySize size_of(const CutCells& cc) {
  double nodes = cc.level_cells.empty() ? static_cast<double>(cc.numbers.corners().size()) : 0;
  for (const CutCells& level : cc.level_cells) nodes += static_cast<double>(level.numbers.corners().size());
  return {nodes, static_cast<double>(cc.active_of_cut.size()), static_cast<double>(cc.solid.geometry().num_facets()),
          cc.grid.plane_strain >= 0};
}

/// Fitted to runs of the scenes of this repository (docs/faq.md, "Time and memory"). In plane strain all cells are cut,
/// and few have points. Cells of the grid that are empty cost nothing.
double expected_memory(const std::vector<BodySize>& bodies, const MemoryExtras& extras) {
  double bytes = program_itself();
  if (extras.pictures) bytes += 13e6;
  if (extras.pictures_of_steps) bytes += 45e6;
  if (extras.fields_beside_pictures) bytes += beside_pictures(bodies);
  if (extras.cad) bytes += 35e6;
  if (const auto& points = extras.points) bytes += 1200 * points->contact + 730 * points->rows + 440 * points->support;
  for (const BodySize& body : bodies) {
    const double per_cut_cell = body.plane_strain ? 3.7e3 : extras.points ? 2e3 : 6.5e3;
    bytes += 165 * body.nodes + per_cut_cell * body.cut_cells + 1.1e3 * body.facets;
  }
  return bytes;
}

MemoryExtras memory_extras(const Scene& scene) {
  MemoryExtras extras;
  extras.pictures = scene.output.plots;
  extras.pictures_of_steps = scene.output.plots && !scene.steps.empty();
  extras.fields_beside_pictures = scene.output.plots && scene.output.fields() && TrilinosScope::concurrency() > 1;
  extras.cad = cad_is_loaded();
  return extras;
}

void check_memory_early(const Scene& scene, bool near_limit_too) {
  const double available = memory_budget().bytes;
  for (const bool finer : {false, true}) {
    std::vector<BodySize> sizes;
    for (const BodySpec& body : scene.bodies) sizes.push_back(estimate_size(body, finer));
    const double expected = expected_memory(sizes, memory_extras(scene));
    if (expected * near_limit < available) return;
    if (expected > near_limit * available || finer) check_memory(scene, sizes, memory_extras(scene));
    if (!near_limit_too) return;
  }
}

std::string forecast_text(double expected) {
  const MemoryBudget budget = memory_budget();
  if (!std::isfinite(budget.bytes) || (!budget.given && expected * near_limit < budget.bytes)) return "";
  return fmt::format("memory: about {} of {} ({})", memory_text(expected), memory_text(budget.bytes), budget.source);
}

double check_memory(const Scene& scene, const std::vector<BodySize>& bodies, const MemoryExtras& extras) {
  const MemoryBudget budget = memory_budget();
  const double expected = expected_memory(bodies, extras);
  if (expected <= budget.bytes) return expected;
  const std::string fitting = fitting_cells(scene, bodies, extras, budget.bytes);
  throw InputError(fmt::format(
      "{}: needs about {} of memory, and there are {} ({}); {}; {}--memory-limit overrides this", scene.file,
      memory_text(expected), memory_text(budget.bytes), budget.source,
      !fitting.empty() ? fitting : "no cell size fits, the program itself needs some " + memory_text(program_itself()),
      budget.remedy.empty() ? "" : budget.remedy + "; "));
}

}  // namespace cgcontact
