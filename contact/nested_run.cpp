#include "contact/nested_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "contact/checks/memory.hpp"
#include "contact/results/verdict/zone_width.hpp"

namespace cgcontact {
namespace {

/// Nodes of the coarsest grid, about; at most 1/64 of the given one's, so that its solve costs little where it finds
/// narrow zones, with few rows of the given cells.
constexpr double min_nodes = 1000;
constexpr int min_halvings = 2;
/// Outer residual of a solution to start from: it is that of other cells, which are off by more.
constexpr double coarse_tolerance = 1e-3;

double count_nodes(const std::vector<BodyModel>& bodies) {
  double nodes = 0;
  for (const BodyModel& body : bodies) nodes += size_of(body.cut_cells).nodes;
  return nodes;
}

/// The same scene on cells of `factor` times the size.
Scene on_coarser_cells(const Scene& given, double factor) {
  Scene scene = given;
  for (BodySpec& body : scene.bodies) {
    body.cell_size *= factor;
    for (RefineSpec& refine : body.refine) refine.size *= factor;
    body.quadtree = body.plane_strain.has_value();  // one layer, whatever its thickness
  }
  if (!scene.steps.empty()) scene.steps.resize(1);
  const double looser = std::max(1.0, coarse_tolerance / scene.solver.tolerance);
  scene.solver.tolerance *= looser;
  scene.solver.linear_tolerance *= looser;
  return scene;
}

/// Cells across the narrowest zone; 0: there is none that ends within a face.
double cells_across(const SolvedState& state) {
  std::optional<double> fewest;
  for (const ZoneWidth& width : zone_widths(state))
    if (width.cells) fewest = std::min(fewest.value_or(*width.cells), *width.cells);
  return fewest.value_or(0);
}

}  // namespace

struct NestedRun::Coarse {
  Coarse(const Scene& given, double factor) : scene(on_coarser_cells(given, factor)), simulation(scene) {}

  Scene scene;
  Simulation simulation;
};

NestedRun::NestedRun(const Scene& scene) : scene_(scene), simulation_(std::make_unique<Simulation>(scene)) {}

/// Solution on cells of twice the size; null: there is none that is worth to start from.
std::unique_ptr<NestedRun::Coarse> NestedRun::solve_coarser(const ProgressCallbacks& progress) {
  int halvings = 0;
  for (double nodes = count_nodes(simulation_->state.bodies) / 8; nodes >= min_nodes; nodes /= 8) ++halvings;
  if (halvings < min_halvings) return nullptr;
  progress.phase("coarser grids");
  ProgressCallbacks steps_only;
  steps_only.step = progress.step;
  std::unique_ptr<Coarse> last;
  for (; halvings > 0; --halvings) {
    auto next = std::make_unique<Coarse>(scene_, std::ldexp(1.0, halvings));
    try {
      next->simulation.set_up({});
      if (last) next->simulation.start_preloads_from(last->simulation);
      next->simulation.solve_system(steps_only, last ? &last->simulation.state : nullptr);
      const SolvedState& state = next->simulation.state;
      coarse_.push_back({state.system.num_free_dofs(), state.outer.iterations, state.outer.converged});
      if (!state.outer.converged) return nullptr;
      next->simulation.recover();
      next->simulation.state.release_assembly_data();
    } catch (const InputError&) {  // of cells that the scene does not have
      return nullptr;
    }
    last = std::move(next);
    // Forecast for cells of twice the given size.
    const double across = std::ldexp(cells_across(last->simulation.state), halvings - 1);
    if (across < scene_.results.wanted_cells_across) return nullptr;
  }
  return last;
}

void NestedRun::run(const ProgressCallbacks& progress) {
  simulation_->set_up(progress);
  const auto start = std::chrono::steady_clock::now();
  std::unique_ptr<Coarse> coarse = scene_.solver.nested ? solve_coarser(progress) : nullptr;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool from_coarse = coarse != nullptr;
  if (from_coarse) simulation_->start_preloads_from(coarse->simulation);
  simulation_->solve_system(progress, from_coarse ? &coarse->simulation.state : nullptr);
  coarse.reset();                                            // before the recovery, which takes most memory
  if (from_coarse && !simulation_->state.outer.converged) {  // once more, from nothing
    simulation_ = std::make_unique<Simulation>(scene_);
    simulation_->set_up(progress);
    simulation_->solve_system(progress, nullptr);
  }
  simulation_->finish(progress, true);
  if (coarse_.empty()) return;
  simulation_->results.coarse_solves = coarse_;
  simulation_->results.times_s.insert(simulation_->results.times_s.begin() + 1, {"coarser grids", seconds});
}

}  // namespace cgcontact
