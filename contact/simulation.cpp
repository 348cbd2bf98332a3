#include "contact/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "contact/model/contact_system.hpp"
#include "contact/preparation.hpp"
#include "contact/results/coarse_facets.hpp"
#include "contact/results/conditions.hpp"
#include "contact/results/contact_rows.hpp"
#include "contact/results/face_problems.hpp"
#include "contact/results/friction_capacity.hpp"
#include "contact/results/holding.hpp"
#include "contact/results/missed_contact.hpp"
#include "contact/results/open_gaps.hpp"
#include "contact/results/pair_figures.hpp"
#include "contact/results/peak_estimate.hpp"
#include "contact/results/postprocess.hpp"
#include "contact/results/pressure_estimate.hpp"
#include "contact/results/pressure_paths.hpp"
#include "contact/results/probes.hpp"
#include "contact/results/reference.hpp"
#include "contact/results/rigid_figures.hpp"
#include "contact/results/slices.hpp"
#include "contact/results/small_strain.hpp"
#include "contact/results/spring_share.hpp"
#include "contact/results/verdict.hpp"
#include "contact/results/zone_figures.hpp"
#include "contact/solve/tangential_drift.hpp"
#include "core/base/memory.hpp"
#include "core/base/parallel.hpp"
#include "core/base/resources.hpp"
#include "recovery/constrained/divergence.hpp"

namespace cgcontact {
namespace {

/// Cells; bodies one cell thick are meant to be so. Those held on both sides (plane strain) may be thinner.
constexpr double nearly_one = 0.99;
/// Cells: a motion along surfaces that is less is rounding.
constexpr double at_rest = 1e-6;
/// Most repeated solves of a pair that has to see farther.
constexpr int max_extensions = 5;

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

/// Returns whether there is no force and no motion.
bool is_at_rest(const OuterResult& outer) {
  const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), outer.u);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (u(i) != 0) return false;
  for (const BodyMotion& motion : outer.body_motions)
    if (motion.translation.norm() + motion.rotation.norm() + motion.expansion.norm() > 0) return false;
  return std::all_of(outer.group_force.begin(), outer.group_force.end(), [](double force) { return force == 0; });
}

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
  phase("solve", [&] { solve_steps(progress, earlier); });
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

namespace {

/// Divisions of a run's steps at most. A bolted joint at 1.2 times the friction of its plates needs three.
constexpr int max_divisions = 4;

/// The end of a step, or a point on the way there from the end of the one before.
struct Increment {
  std::size_t step;
  double fraction;
};

StepSpec step_of(const std::vector<StepSpec>& steps, const Increment& increment) {
  StepSpec step = steps[increment.step];
  if (increment.fraction == 1) return step;
  const StepSpec& before = steps[increment.step - 1];
  const auto between = [&](double a, double b) { return a + increment.fraction * (b - a); };
  step.loads = between(before.loads, step.loads);
  step.displacements = between(before.displacements, step.displacements);
  step.interference = between(before.interference, step.interference);
  step.fraction = increment.fraction;
  return step;
}

}  // namespace

/// Solves all steps, each from the one before; figures of each, if the scene has steps. The last one is the result.
/// With friction a step that does not converge is divided, and all of them come again.
void Simulation::solve_steps(const ProgressCallbacks& progress, const SolvedState* earlier) {
  const std::vector<StepSpec> steps = state.scene.steps.empty() ? std::vector<StepSpec>{{}} : state.scene.steps;
  const auto make_solver = [&] {
    return std::make_unique<ContactSolver>(
        OuterProblem{state.scene, state.bodies, state.pairs, state.supports, state.system, state.scales, exec_},
        earlier);
  };
  preload_.begin(state.bodies, state.pairs);
  bool tightened = false;
  auto solver = make_solver();
  const auto begin_again = [&](std::size_t& increment) {
    solver = make_solver();
    increment = first_increment_of_new_solver(increment);
  };
  std::string first_failure;
  int extensions = 0;
  // The solution before bodies were held for having let go of their contact, and its closed points.
  std::optional<std::pair<OuterResult, std::vector<ContactPair>>> not_held;
  std::size_t supports_not_held = 0;
  std::vector<Increment> increments;
  for (std::size_t k = 0; k < steps.size(); ++k) increments.push_back({k, 1});
  for (std::size_t i = 0; i < increments.size();) {
    const std::size_t k = increments[i].step;
    const bool is_end = increments[i].fraction == 1;
    set_step(step_of(steps, increments[i]));
    state.outer = solver->solve(progress.step);
    if (state.outer.drifts) {
      constrain_drift();
      auto held = make_solver();
      if (!rubs()) held->warm_start_from(*solver);
      solver = std::move(held);
      i = first_increment_of_new_solver(i);
      continue;
    }
    if (state.outer.converged && extensions < max_extensions && extend_contact_search()) {
      ++extensions;
      make_system();
      begin_again(i);
      continue;
    }
    if (k == 0 && state.outer.converged && tighten()) {
      tightened = true;
      continue;
    }
    if (not_held && !state.outer.converged) {  // they touch nothing, held or not
      std::tie(state.outer, state.pairs) = *not_held;
      state.supports.resize(supports_not_held);
      make_system();
    }
    if (!first_failure.empty() && rubs() && state.outer.converged) {
      state.outer.converged = false;
      state.outer.diagnosis = "friction remembers the steps before, and one of them has no solution";
    }
    const std::string fault = state.outer.converged ? contact_fault(state) : "";
    if (!not_held && state.outer.converged && lost_by_drift(fault)) {
      not_held = {state.outer, state.pairs};
      supports_not_held = state.supports.size();
      constrain_drift();
      begin_again(i);
      continue;
    }
    if (!fault.empty()) {
      state.outer.converged = false;
      state.outer.other_cells_may_help = true;
      state.outer.diagnosis = fault;
    }
    if (std::exchange(tightened, false) && !state.outer.converged) continue;  // once more, from nothing
    const bool ran_out = !state.outer.converged && fault.empty() && state.outer.other_cells_may_help;
    if (k > 0 && rubs() && ran_out && first_failure.empty() && increments.size() < steps.size() + max_divisions) {
      const double begin = increments[i - 1].step == k ? increments[i - 1].fraction : 0;
      increments.insert(increments.begin() + i, {k, (begin + increments[i].fraction) / 2});
      make_system();
      begin_again(i);
      continue;
    }
    if (is_end && !state.scene.steps.empty()) record_step(k, progress);
    if (is_end && !state.scene.steps.empty() && state.outer.converged && is_at_rest(state.outer))
      add_warning(
          fmt::format("step {} of {}: nothing acts, neither loads nor prescribed displacements nor overlap: no "
                      "force and no motion",
                      k + 1, steps.size()));
    if (!state.outer.converged && first_failure.empty())
      first_failure = state.scene.steps.empty()
                          ? state.outer.diagnosis
                          : fmt::format("step {} of {}: {}", k + 1, steps.size(), state.outer.diagnosis);
    not_held.reset();
    if (state.outer.converged) solver->end_step();
    ++i;
  }
  for (std::size_t k = 1; k < steps.size(); ++k)
    if (const auto count = std::count_if(increments.begin(), increments.end(),
                                         [k](const Increment& increment) { return increment.step == k; });
        count > 1)
      add_warning(fmt::format("step {} of {}: with friction it did not converge at once, {} {} increments", k + 1,
                              steps.size(), results.steps[k].converged ? "but in" : "nor in", count));
  if (state.outer.fallbacks > 0)
    add_warning(fmt::format("multigrid gave up ({}): MueLu preconditioned {} linear solves in its place",
                            state.outer.why_fallback, state.outer.fallbacks));
  for (std::size_t k = 0; k < state.pairs.size() && k < state.outer.small_zone_groups.size(); ++k)
    if (state.outer.small_zone_groups[k] > 0)
      add_warning(
          fmt::format("contact \"{}\": a zone smaller than the cells in {} of them; its force is that of an "
                      "indented half-space, not resolved",
                      state.pairs[k].spec->name, state.outer.small_zone_groups[k]));
  state.outer.converged = first_failure.empty();
  state.outer.diagnosis = first_failure;
}

bool Simulation::rubs() const {
  return std::any_of(state.pairs.begin(), state.pairs.end(),
                     [](const ContactPair& pair) { return pair.num_tangents > 0; });
}

/// A new solver does not know what friction has done in the steps before: with friction all of them come again.
std::size_t Simulation::first_increment_of_new_solver(std::size_t increment) {
  if (!rubs()) return increment;
  preload_.begin_again();
  results.steps.clear();
  return 0;
}

/// Loads, prescribed displacements and interferences of a step.
void Simulation::set_step(const StepSpec& step) {
  for (BodyModel& body : state.bodies) set_loads(state.scene, step, body);
  for (SupportPoint& p : state.supports)
    if (!p.follows) p.value = p.support < 0 ? 0 : step.of(state.scene.supports[p.support]) * p.prescribed;
  for (ContactPair& pair : state.pairs)
    set_interference(pair, step.interference * (pair.spec->interference + preload_.tightening(pair)));
}

/// False: all pairs have the forces that they are to be tightened to.
bool Simulation::tighten() {
  if (!preload_.any()) return false;
  std::vector<double> forces = normal_forces(state);
  for (std::size_t k = 0; k < forces.size(); ++k) forces[k] *= state.bodies[state.pairs[k].primary].slices;
  return preload_.tighten(state.pairs, forces);
}

/// New pairs, if faces have met that no pair saw.
bool Simulation::extend_contact_search() {
  const std::vector<double> reach = missed_contact(state);
  if (reach.empty()) return false;
  state.pairs = make_contact_pairs(state.scene, state.bodies, reach);
  return true;
}

/// Bodies stay where they are along surfaces, as far as no load drives them.
void Simulation::constrain_drift() {
  for (const SupportPoint& point : TangentialDrift(state.bodies, state.supports, state.pairs).hold(state.bodies))
    state.supports.push_back(point);
  make_system();
}

/// Returns whether a body that nothing drives slid or spun along surfaces until its contact let go. Unlike exact
/// contact, points of few cells push it along.
bool Simulation::lost_by_drift(const std::string& fault) const {
  if (fault.empty() && contact_carries(state)) return false;
  return TangentialDrift(state.bodies, state.supports, state.pairs).farthest(state.outer.body_motions) > at_rest;
}

/// Figures of a step; the pairs of the last one are those of the results.
void Simulation::record_step(std::size_t number, const ProgressCallbacks& progress) {
  Results step_results;
  if (number + 1 < state.scene.steps.size()) {
    recover();
    fill_contact_rows(state, step_results);
    fill_pair_figures(state, step_results);
    fill_friction(state, step_results);
    fill_fields(state, step_results);
    progress.load_step(number, step_results);
  }
  results.steps.push_back(
      {state.scene.steps[number], state.outer.iterations, state.outer.converged, step_results.pairs, {}});
}

void Simulation::set_up_grids() {
  for (const BodySpec& body : state.scene.bodies) {
    results.warnings.insert(results.warnings.end(), body.warnings.begin(), body.warnings.end());
    if (body.material.poisson_ratio > 0.48)
      results.warnings.push_back(fmt::format(
          "body \"{}\": nu = {:g}: trilinear elements lock near 0.5 and lose accuracy, compare with finer cells",
          body.name, body.material.poisson_ratio));
  }
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

void Simulation::make_system() {
  for (BodyModel& body : state.bodies) body.cut_cells.gather_moments();
  state.scales = make_scales(state.scene);
  state.system = make_contact_system(state.scene, state.bodies, state.supports, state.pairs, state.scales, exec_);
}

/// Once, however many steps give it.
void Simulation::add_warning(const std::string& warning) {
  std::vector<std::string>& all = results.warnings;
  if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
}

void Simulation::recover() {
  state.spr.clear();
  state.sprc.clear();
  for (BodyModel& body : state.bodies) body.cut_cells.gather_moments();
  const RecoveryOptions& options = state.scene.recovery;
  // Interior patches follow from the displacements by themselves, unless they are to have polynomials of degree 2.
  const bool interior_apart = !options.spr_c || options.degree.interior == 1;
  std::vector<double> group_force = state.outer.group_force;
  for (double& force : group_force) force *= force_unit(state);
  update_contact_links(state.pairs, state.bodies, group_force, state.outer.friction);
  std::vector<PatchSet> patches(state.bodies.size());
  std::vector<RecoveryBody> input;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodyMesh& mesh = state.system.meshes[b];
    const BoundaryData& boundary = state.bodies[b].boundary;
    RecoveredField field;
    if (interior_apart && !mesh.rigid) {
      field.nodes = nodes_beside_interior(mesh, boundary.links_of_cell);
      field.interior = std::make_shared<InteriorFit>(mesh, state.outer.u, false);
    } else {
      field.nodes = Subset(mesh.num_nodes);
    }
    field.values = CoefficientView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::simulation::recovered"),
                                   field.nodes.size());
    patches[b] = make_patches(mesh, options.patch_volume, field.nodes);
    if (mesh.rigid) Kokkos::deep_copy(field.values, 0.0);
    const int singular = mesh.rigid ? 0 : recover_all(mesh, patches[b], state.outer.u, field);
    if (singular > 0)
      add_warning(std::to_string(singular) + " patches of body \"" + state.bodies[b].spec->name +
                  "\" were singular: constant stress used there");
    state.spr.push_back(
        restricted_field(field, nodes_near_contact(state.pairs, state.bodies, static_cast<int>(b), mesh)));
    state.sprc.push_back(field);
    input.push_back({&mesh, &patches[b], &boundary, field});
  }
  const bool on_face = options.spr_c && options.pressure == PressureSource::face;
  if (on_face) solve_faces();
  if (options.spr_c) {
    ConstrainedRecovery recovery =
        recover_constrained(HostExec(), input, state.outer.u, state.scales, options, on_face ? &state.faces : nullptr);
    state.recovery_counts = recovery.counts;
    state.patch_states = std::move(recovery.states);
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
      if (!recovery.quadratic[b].values.empty())
        state.sprc[b].quadratic = std::make_shared<QuadraticTerms>(std::move(recovery.quadratic[b]));
      if (!recovery.edges[b].terms.empty())
        state.sprc[b].edge = std::make_shared<EdgeTerms>(std::move(recovery.edges[b]));
      if (state.sprc[b].interior)
        state.sprc[b].interior = std::make_shared<InteriorFit>(
            state.system.meshes[b], state.outer.u, true,
            divergence_at_nodes(state.system.meshes[b], state.bodies[b].boundary, state.scales.stress));
    }
  }
}

void Simulation::solve_faces() {
  state.faces = solve_face_pressures(exec_, state);
  for (const SolvedZone& zone : state.faces.zones)
    if (const FaceSolution& solution = zone.pressure.solution; !solution.converged)
      add_warning(
          fmt::format("contact \"{}\": the problem on its face stopped after {} iterations, its pressure still "
                      "changes by {:.2g} of the force (recovery.face.max_iterations)",
                      state.pairs[zone.pair].spec->name, solution.iterations, solution.change));
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

void Simulation::fill_results() {
  fill_counts(state, results);
  fill_contact_rows(state, results);
  if (const std::string held = held_contact(state, results); state.outer.converged && !held.empty()) {
    results.converged = state.outer.converged = false;
    results.diagnosis = state.outer.diagnosis = held;
  }
  fill_pair_figures(state, results);
  fill_support_figures(state, results);
  if (!results.steps.empty()) results.steps.back().pairs = results.pairs;
  fill_balance(state, results);
  if (const std::string warning = surface_hold_warning(state); !warning.empty()) add_warning(warning);
  choose_reference();
  fill_body_fields(state, results);
  fill_rigid_figures(state, results);
  estimate_gap_errors(state, results);
  results.verdict = judge(state, results);
  estimate_contact_errors(state, results);
  judge_errors(state, results);
  report_spring_shares(state, results);
  estimate_peak_errors(results);
  fill_conditions(state, results);
  fill_pressure_errors(state, results);
  if (state.outer.converged)
    for (const auto& warnings :
         {small_strain_warnings(state, results), lost_force_warnings(state, results),
          unclear_gap_warnings(state, results), coarse_facet_warnings(state), friction_warnings(state)})
      for (const std::string& warning : warnings) add_warning(warning);
  scale_to_thickness(state, results);
  fill_zone_figures(state, results);
  fill_friction(state, results);
  if (!results.steps.empty())
    for (std::size_t k = 0; k < results.pairs.size(); ++k)
      results.steps.back().pairs[k].friction = results.pairs[k].friction;
}

}  // namespace cgcontact
