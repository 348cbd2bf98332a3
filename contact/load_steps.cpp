#include "contact/load_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "contact/results/estimates/friction_capacity.hpp"
#include "contact/results/estimates/open_force.hpp"
#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/figures/postprocess.hpp"
#include "contact/results/verdict/missed_contact.hpp"
#include "contact/solve/floating/tangential_drift.hpp"
#include "contact/stress_recovery.hpp"

namespace cgcontact {
namespace {

/// Cells: a motion along surfaces that is less is rounding.
constexpr double at_rest = 1e-6;
/// Most repeated solves of a pair that has to see farther.
constexpr int max_extensions = 5;
/// Divisions of a run's steps at most. A bolted joint at 1.2 times the friction of its plates needs three.
constexpr int max_divisions = 4;

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

LoadSteps::LoadSteps(const ExecSpace& exec, SolvedState& state, Results& results, Preload& preload,
                     const ProgressCallbacks& progress, const SolvedState* earlier)
    : exec_(exec),
      state_(state),
      results_(results),
      preload_(preload),
      progress_(progress),
      earlier_(earlier),
      steps_(state.scene.steps.empty() ? std::vector<StepSpec>{{}} : state.scene.steps) {
  for (std::size_t k = 0; k < steps_.size(); ++k) increments_.push_back({k, 1});
}

/// After each solve one of the cases applies: something is changed and the increment solved again, or it is accepted.
void LoadSteps::run() {
  preload_.begin(state_.bodies, state_.pairs);
  solver_ = make_solver();
  while (present_ < increments_.size()) {
    solve_increment();
    if (hold_drifting_bodies() || search_farther() || tighten_preloads()) continue;
    find_fault();
    if (hold_lost_bodies() || repeat_tightened() || divide_step()) continue;
    accept();
  }
  end();
}

void LoadSteps::solve_increment() {
  set_loads_of(present_step());
  state_.take(solver_->solve(progress_.step));
}

/// Returns the factors of loads, prescribed displacements and interferences in the present increment.
StepSpec LoadSteps::present_step() const {
  const Increment& increment = increments_[present_];
  StepSpec step = steps_[increment.step];
  if (increment.fraction == 1) return step;
  const StepSpec& before = steps_[increment.step - 1];
  const auto between = [&](double a, double b) { return a + increment.fraction * (b - a); };
  step.loads = between(before.loads, step.loads);
  step.displacements = between(before.displacements, step.displacements);
  step.interference = between(before.interference, step.interference);
  step.fraction = increment.fraction;
  return step;
}

void LoadSteps::set_loads_of(const StepSpec& step) {
  for (BodyModel& body : state_.bodies) set_loads(state_.scene, step, body);
  for (SupportPoint& p : state_.supports)
    if (!p.follows) p.value = p.support < 0 ? 0 : step.of(state_.scene.supports[p.support]) * p.prescribed;
  for (ContactPair& pair : state_.pairs)
    set_interference(pair, step.interference * (pair.spec->interference + preload_.tightening(pair)));
}

/// Holds bodies that drift along surfaces without end, which the solver has stopped for.
bool LoadSteps::hold_drifting_bodies() {
  if (!state_.outer.drifts) return false;
  hold_along_surfaces();
  renew_solver(!has_friction());
  return true;
}

/// Makes new pairs that see farther, if faces have met that no pair saw.
bool LoadSteps::search_farther() {
  if (!state_.outer.converged || num_extensions_ == max_extensions) return false;
  const std::vector<double> reach = missed_contact(state_);
  if (reach.empty()) return false;
  state_.pairs = make_contact_pairs(state_.scene, state_.bodies, reach);
  ++num_extensions_;
  state_.make_system(exec_);
  renew_solver(false);
  return true;
}

/// Changes the interference of pairs that do not have the force yet that they are to be tightened to in the first step.
bool LoadSteps::tighten_preloads() {
  if (increments_[present_].step > 0 || !state_.outer.converged || !preload_.any()) return false;
  std::vector<double> forces = normal_forces(state_);
  for (std::size_t k = 0; k < forces.size(); ++k) forces[k] *= state_.bodies[state_.pairs[k].primary].slices;
  if (!preload_.tighten(state_.pairs, forces)) return false;
  tightened_ = true;
  return true;
}

/// Judges a solution that converged. Where there is none with bodies held, the one before is taken; with friction no
/// step has a solution after one without; forces of contact have to balance the others.
void LoadSteps::find_fault() {
  OuterResult& outer = state_.outer;
  if (not_held_ && !outer.converged) release_lost_bodies();
  if (!first_failure_.empty() && has_friction() && outer.converged) {
    outer.converged = false;
    outer.diagnosis = "friction remembers the steps before, and one of them has no solution";
  }
  fault_ = outer.converged ? contact_fault(state_) : "";
}

/// Holds bodies that nothing drives, but that slid or spun along surfaces until their contact let go: unlike exact
/// contact, points of few cells push them along.
bool LoadSteps::hold_lost_bodies() {
  if (not_held_ || !state_.outer.converged) return false;
  if (fault_.empty() && contact_carries(state_)) return false;
  if (!(TangentialDrift(state_.bodies, state_.supports, state_.pairs).farthest(state_.outer.body_motions) > at_rest))
    return false;
  not_held_ = NotHeld{state_.outer, state_.pairs, state_.supports.size()};
  hold_along_surfaces();
  renew_solver(false);
  return true;
}

/// Takes back what hold_lost_bodies has done: the bodies touch nothing, held or not.
void LoadSteps::release_lost_bodies() {
  state_.take(not_held_->outer);
  state_.pairs = not_held_->pairs;
  state_.supports.resize(not_held_->num_supports);
  state_.make_system(exec_);
}

/// Repeats a failure after preloads were changed: it counts only if it comes again, from nothing.
bool LoadSteps::repeat_tightened() { return std::exchange(tightened_, false) && !is_solved(); }

/// Divides a step with friction in which the outer iteration ran out.
bool LoadSteps::divide_step() {
  const auto [step, fraction] = increments_[present_];
  const bool ran_out = !state_.outer.converged && state_.outer.other_cells_may_help;
  if (step == 0 || !has_friction() || !ran_out || !first_failure_.empty() ||
      increments_.size() >= steps_.size() + max_divisions)
    return false;
  const Increment& before = increments_[present_ - 1];
  const double begin = before.step == step ? before.fraction : 0;
  increments_.insert(increments_.begin() + static_cast<std::ptrdiff_t>(present_), {step, (begin + fraction) / 2});
  state_.make_system(exec_);
  renew_solver(false);
  return true;
}

/// Takes the present solution, or the failure, and goes on.
void LoadSteps::accept() {
  const auto [step, fraction] = increments_[present_];
  OuterResult& outer = state_.outer;
  if (!fault_.empty()) {
    outer.converged = false;
    outer.other_cells_may_help = outer.lost_contact = true;
    outer.diagnosis = fault_;
  }
  if (fraction == 1 && !state_.scene.steps.empty()) record_step();
  if (!outer.converged && first_failure_.empty())
    first_failure_ =
        state_.scene.steps.empty()
            ? outer.diagnosis
            : fmt::format("{}{}: {}", name_of_step(step),
                          fraction < 1 ? fmt::format(" at {:.3g} of its change", fraction) : "", outer.diagnosis);
  not_held_.reset();
  if (outer.converged) solver_->end_step();
  ++present_;
}

/// Records the figures of a step; the pairs of the last one are those of the results.
void LoadSteps::record_step() {
  const std::size_t step = increments_[present_].step;
  Results of_step;
  if (step + 1 < steps_.size()) {
    for (const std::string& warning : recover_stresses(exec_, state_)) add_warning(results_, warning);
    of_step.contact_rows = contact_rows(state_);
    of_step.pairs = pair_figures(state_, of_step.contact_rows);
    fill_friction(state_, of_step);
    of_step.bodies = body_fields(state_);
    progress_.load_step(step, of_step);
  }
  results_.steps.push_back({steps_[step], state_.outer.iterations, state_.outer.converged, of_step.pairs, {}});
  if (state_.outer.converged && is_at_rest(state_.outer))
    add_warning(results_, fmt::format("{}: nothing acts, neither loads nor prescribed displacements nor overlap: no "
                                      "force and no motion",
                                      name_of_step(step)));
}

/// Ends the run: what it took, and whether all steps have a solution.
void LoadSteps::end() {
  warn_of_divided_steps();
  warn_of_solver();
  solve_approaches();
  state_.outer.converged = first_failure_.empty();
  state_.outer.diagnosis = first_failure_;
}

/// Solves for the approaches of the pairs whose force depends on how stiff the bodies are, for the estimate of its
/// error.
void LoadSteps::solve_approaches() {
  state_.approaches.clear();
  if (!state_.outer.converged) return;
  const std::vector<OpenForce> forces = open_forces(state_, pair_figures(state_, {}));
  for (int k = 0; k < static_cast<int>(forces.size()); ++k) {
    if (forces[k].fraction == 0 || state_.pairs[k].bonded()) continue;
    Approach approach = solver_->approach(k);
    if (approach.u.size() > 0)
      state_.approaches.push_back(std::move(approach));
    else
      add_warning(
          results_,
          fmt::format("contact \"{}\": the linear solver failed for what the error of its force is estimated by: "
                      "the estimate is that of the energy, which can be several times too small or too large",
                      state_.pairs[k].spec->name));
  }
}

void LoadSteps::warn_of_divided_steps() {
  for (std::size_t k = 1; k < steps_.size(); ++k) {
    const auto count = std::count_if(increments_.begin(), increments_.end(),
                                     [k](const Increment& increment) { return increment.step == k; });
    if (count > 1)
      add_warning(results_, fmt::format("{}: with friction it did not converge at once, {} {} increments",
                                        name_of_step(k), results_.steps[k].converged ? "but in" : "nor in", count));
  }
}

void LoadSteps::warn_of_solver() {
  const OuterResult& outer = state_.outer;
  if (outer.fallbacks > 0)
    add_warning(results_, fmt::format("multigrid gave up ({}): MueLu preconditioned {} linear solves in its place",
                                      outer.why_fallback, outer.fallbacks));
  for (std::size_t k = 0; k < state_.pairs.size() && k < outer.small_zone_groups.size(); ++k)
    if (outer.small_zone_groups[k] > 0)
      add_warning(results_,
                  fmt::format("contact \"{}\": a zone smaller than the cells in {} of them; its force is that of an "
                              "indented half-space, not resolved",
                              state_.pairs[k].spec->name, outer.small_zone_groups[k]));
}

std::unique_ptr<ContactSolver> LoadSteps::make_solver() {
  return std::make_unique<ContactSolver>(
      OuterProblem{state_.scene, state_.bodies, state_.pairs, state_.supports, state_.system, state_.scales, exec_},
      earlier_);
}

/// Makes a solver for changed pairs or supports; from_present: starts from where the present one stopped. It does not
/// know what friction has done in the steps before: with friction all of them come again.
void LoadSteps::renew_solver(bool from_present) {
  std::unique_ptr<ContactSolver> renewed = make_solver();
  if (from_present) renewed->warm_start_from(*solver_);
  solver_ = std::move(renewed);
  if (!has_friction()) return;
  preload_.begin_again();
  results_.steps.clear();
  present_ = 0;
}

/// Holds bodies where they are along surfaces, as far as no load drives them.
void LoadSteps::hold_along_surfaces() {
  for (const SupportPoint& point : TangentialDrift(state_.bodies, state_.supports, state_.pairs).hold(state_.bodies))
    state_.supports.push_back(point);
  state_.make_system(exec_);
}

bool LoadSteps::has_friction() const {
  return std::any_of(state_.pairs.begin(), state_.pairs.end(),
                     [](const ContactPair& pair) { return pair.num_tangents > 0; });
}

std::string LoadSteps::name_of_step(std::size_t step) const {
  return fmt::format("step {} of {}", step + 1, steps_.size());
}

}  // namespace cgcontact
