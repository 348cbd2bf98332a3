#include "contact/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "contact/load_steps.hpp"
#include "contact/preparation.hpp"
#include "contact/results/estimates/friction_capacity.hpp"
#include "contact/results/estimates/peak_estimate.hpp"
#include "contact/results/estimates/pressure_estimate.hpp"
#include "contact/results/figures/conditions.hpp"
#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/figures/postprocess.hpp"
#include "contact/results/figures/pressure_paths.hpp"
#include "contact/results/figures/probes.hpp"
#include "contact/results/figures/rigid_figures.hpp"
#include "contact/results/figures/slices.hpp"
#include "contact/results/figures/spring_share.hpp"
#include "contact/results/figures/zone_figures.hpp"
#include "contact/results/reference/reference.hpp"
#include "contact/results/verdict/coarse_facets.hpp"
#include "contact/results/verdict/open_gaps.hpp"
#include "contact/results/verdict/small_strain.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "contact/stress_recovery.hpp"
#include "core/base/process/memory.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/resources.hpp"

namespace cgcontact {
namespace {

/// Cells; bodies one cell thick are meant to be so. Those held on both sides (plane strain) may be thinner.
constexpr double nearly_one = 0.99;

/// Shortest side of the bounding box along the grid's axes, and twice the volume over the free area: in the body's
/// smallest cells.
std::pair<double, double> thickness_in_cells(const BodyModel& body) {
  Vec3 min, max;
  body.spec->solid.transformed(body.spec->grid_rotation.transpose(), Vec3::Zero()).bounding_box(min, max);
  Vec3 extent = max - min;
  if (body.spec->quadtree) extent[static_cast<int>(*body.spec->plane_strain)] = std::numeric_limits<double>::infinity();
  int finest = 0;
  for (int c = 0; c < static_cast<int>(body.cut_cells.cells.size()); ++c)
    finest = std::max(finest, body.cut_cells.level(c));
  return {extent.minCoeff() / body.cut_cells.grid.cell_size_of(finest), std::ldexp(body.free_thickness, finest)};
}

/// Wall time of named phases; a phase that comes again adds to its time.
class PhaseClock {
 public:
  PhaseClock(std::vector<std::pair<std::string, double>>& times, const ProgressCallbacks& progress)
      : times_(times), progress_(progress) {}
  template <class Work>
  void operator()(const std::string& phase, const Work& work) {
    progress_.phase(phase);
    const ProfiledRegion region(phase.c_str());
    const auto start = std::chrono::steady_clock::now();
    work();
    Kokkos::fence();
    return_freed_memory();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (auto& [name, sum] : times_)
      if (name == phase) {
        sum += seconds;
        return;
      }
    times_.emplace_back(phase, seconds);
  }

 private:
  std::vector<std::pair<std::string, double>>& times_;
  const ProgressCallbacks& progress_;
};

}  // namespace

void Simulation::run(const ProgressCallbacks& progress) {
  set_up(progress);
  solve(progress);
}

void Simulation::sample_paths(const ProgressCallbacks& progress) {
  PhaseClock(results.times_s, progress)("error estimate", [&] {
    fill_paths(state, results);
    fill_probes(state, results);
  });
}

void Simulation::set_up(const ProgressCallbacks& progress) {
  PhaseClock(results.times_s, progress)("cut cells", [&] { set_up_grids(); });
}

void Simulation::solve(const ProgressCallbacks& progress, const SolvedState* earlier, bool with_paths) {
  solve_system(progress, earlier);
  finish(progress, with_paths);
}

void Simulation::solve_system(const ProgressCallbacks& progress, const SolvedState* earlier) {
  progress.memory(expected_memory_);
  PhaseClock phase(results.times_s, progress);
  phase("operator", [&] { make_system(); });
  phase("solve", [&] { LoadSteps(exec_, state, results, preload_, progress, earlier).run(); });
  state.system.supports.clear();  // in the solution
}

void Simulation::finish(const ProgressCallbacks& progress, bool with_paths) {
  PhaseClock phase(results.times_s, progress);
  phase("recovery", [&] { recover(); });
  phase("error estimate", [&] {
    fill_results();
    if (with_paths) fill_paths(state, results);
    if (with_paths) fill_probes(state, results);
  });
  results.peak_memory_bytes = peak_memory_bytes();
}

void Simulation::set_up_grids() {
  for (const BodySpec& body : state.scene.bodies)
    results.warnings.insert(results.warnings.end(), body.warnings.begin(), body.warnings.end());
  Preparation p = prepare(state.scene);
  expected_memory_ = check_memory(state.scene, p);
  state.bodies = std::move(p.bodies);
  for (const BodyModel& body : state.bodies)
    if (const auto [thickness, free_thickness] = thickness_in_cells(body);
        !body.spec->rigid() && thickness < nearly_one && free_thickness < 1)
      results.warnings.push_back(
          fmt::format("body \"{}\": its bounding box is {:.2g} cells thin: bending and the stress "
                      "across it are not resolved, smaller cells are needed",
                      body.spec->name, thickness));
  state.supports = std::move(p.supports);
  state.pairs = std::move(p.pairs);
  results.warnings.insert(results.warnings.end(), p.warnings.begin(), p.warnings.end());
}

void Simulation::make_system() { state.make_system(exec_); }

void Simulation::recover() {
  for (const std::string& warning : recover_stresses(exec_, state)) add_warning(results, warning);
}

/// The scene's reference at the computed force. Without any force, one that depends on it says nothing.
void Simulation::choose_reference() {
  const double force =
      results.pairs.empty() ? 0 : state.bodies.front().slices * results.pairs.front().force_on_first.norm();
  if (!state.scene.reference_of_force || force > 0) {
    try {
      state.reference = state.scene.reference_at(force);
      const Reference known(state.scene, state.reference);
      for (const ContactRow& row : results.contact_rows)
        if (known.has_pressure()) known.pressure(row.x);
    } catch (const InputError& error) {  // known only now: the solution is none the worse for it
      state.reference = {};
      results.warnings.push_back(fmt::format("the reference is left out: {}", error.what()));
    }
  } else {
    state.reference = {};
    results.warnings.emplace_back(
        "the first contact pair carries no force: the reference depends on it and is left out");
  }
}

/// Fills the results in the order in which they need each other.
void Simulation::fill_results() {
  fill_counts(state, results);
  fill_forces();
  choose_reference();
  fill_fields();
  estimate_errors();
  results.loads = load_figures(state.scene, state.bodies);
  fill_conditions(state, results);
  fill_pressure_errors(state, results);
  if (state.outer.converged) warn_of_results();
  scale_to_thickness(state, results);  // so far figures are those of a slice
  set_zone_figures(state, results.contact_rows, results.pairs);
  fill_friction(state, results);
  if (!results.steps.empty())
    for (std::size_t k = 0; k < results.pairs.size(); ++k)
      results.steps.back().pairs[k].friction = results.pairs[k].friction;
}

/// Fills what acts at contact and supports.
void Simulation::fill_forces() {
  results.contact_rows = contact_rows(state);
  if (const std::string held = held_contact(state, results.contact_rows); state.outer.converged && !held.empty()) {
    results.converged = state.outer.converged = false;
    results.diagnosis = state.outer.diagnosis = held;
  }
  results.pairs = pair_figures(state, results.contact_rows);
  if (!results.steps.empty()) results.steps.back().pairs = results.pairs;
  results.supports = support_figures(state);
  results.balance = balance_of_bodies(state, results.supports, results.pairs);
  if (const std::string warning = surface_hold_warning(state); !warning.empty()) add_warning(results, warning);
}

/// Fills the bodies, with the errors of their energy.
void Simulation::fill_fields() {
  results.bodies = body_fields(state);
  estimate_energy_errors(state, results);
  set_rigid_figures(state, results.pairs, results.bodies);
}

/// Estimates errors and judges: the verdict needs the errors of the gaps; those of the contact need the verdict, and
/// may change it.
void Simulation::estimate_errors() {
  estimate_gap_errors(state, results.contact_rows, results.bodies, results.pairs);
  results.verdict = judge(state, results);
  estimate_contact_errors(state, results);
  judge_errors(state, results);
  report_spring_shares(state, results);
  estimate_peak_errors(results);
}

/// Warns of what may be wrong with a solution that converged.
void Simulation::warn_of_results() {
  for (const auto& warnings :
       {results.verdict.notes, small_strain_warnings(state, results.contact_rows),
        lost_force_warnings(state, results.contact_rows, results.pairs), unclear_gap_warnings(state, results.pairs),
        coarse_facet_warnings(state), friction_warnings(state)})
    for (const std::string& warning : warnings) add_warning(results, warning);
}

}  // namespace cgcontact
