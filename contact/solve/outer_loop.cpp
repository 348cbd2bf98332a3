#include "contact/solve/outer_loop.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>
#include <utility>

#include "contact/groups/contact_system.hpp"
#include "contact/motions/free_components.hpp"
#include "contact/solve/active_set.hpp"
#include "contact/solve/active_set_history.hpp"
#include "contact/solve/diagnosis.hpp"
#include "contact/solve/floating/tangential_drift.hpp"
#include "contact/solve/lagged_stress.hpp"
#include "contact/solve/line_search.hpp"
#include "contact/solve/outer_start.hpp"
#include "contact/solve/right_hand_side.hpp"
#include "contact/solve/soft_contact.hpp"
#include "core/base/process/memory.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {
namespace {

/// Motions that are resisted by less than this fraction of the rest are named when the solver fails: a body on one
/// small curved contact is as good as free.
constexpr double hardly_any_stiffness = 1e-3;
/// Largest sliding of a body along surfaces, in the cells that it touches with. Bodies that come to rest go 1.4 at most
/// on the scenes of this repository, those that do not 5 to 411 (docs/decisions.md).
constexpr double max_drift = 3;
/// Fall of residuals below which, while no point changes, they may be the linear solve's error: the lagged stress
/// contracts like 2.7 / kappa at worst. The next ones are solved `tighter`.
constexpr double slow_fall = 0.5, tighter = 0.1;
/// Iterations, and a residual, after which bodies that still drift by more than the third (cells) are held, if the
/// residual does not fall by half in two iterations.
constexpr std::size_t patience = 7;
constexpr double nearly_converged = 1e-3, no_drift = 0.05;
/// With friction the iteration may take this many times as long if the residual falls to this fraction in some
/// iterations.
constexpr int longest = 4;
constexpr std::size_t falls_in = 5;
constexpr double falls_to = 0.8;
/// Relative error of what an estimate is made of. An estimate needs two digits; the rounding of CG, which depends on
/// the number of ranks, left 3e-7 of it with 1e-2 and leaves less than 1e-9 with 1e-4.
constexpr double approach_tolerance = 1e-4;

}  // namespace

struct ContactSolver::Impl {
  Impl(const OuterProblem& problem, const SolvedState* earlier);
  OuterResult run(const std::function<void(const OuterStep&)>& progress);

  OuterResult iterate(const std::function<void(const OuterStep&)>& progress, bool held);
  void take_loads();
  void assemble();
  bool may_go_on(int iteration, const std::vector<double>& residuals) const;
  double renew_stress();
  bool slides_at_once() const;
  void begin_sliding(const RealView& before);
  void renew_friction(const RealView& change);
  void take_turned_rows();
  void update_solver();
  LinearSolveResult solve_linear(double tolerance);
  void warm_start_from(const Impl& other);
  bool drift_exceeded() const;
  bool keeps_drifting(const std::vector<double>& residuals) const;
  bool contact_holds_floating_bodies();
  FreeMotions balance_floating_bodies(bool by_law);
  void polish(OuterResult& result);
  void record(OuterResult& result, OuterStep& step, const std::function<void(const OuterStep&)>& progress) const;
  OuterResult end(int iteration, const std::string& why, OuterResult result) const;
  OuterResult stop(int iteration, const std::string& why, OuterResult result) const;
  void set_forces(OuterResult& result) const;
  void end_step();
  Approach approach(int pair);

  const SolverOptions& settings() const { return problem_.scene.solver; }

  OuterProblem problem_;
  const SolvedState* earlier_;  // that the first run starts from, or none
  LinearSolver solver_;
  Iterate now_;
  std::unique_ptr<LaggedStress> lagged_stress_;  // once the solver is set up, which takes most memory
  RightHandSide right_hand_side_;
  std::vector<Vec3> load_of_body_;          // N
  FreeMotions unbalanced_;                  // what the loads drive without end
  bool slides_into_place_ = false;          // whether this step began without friction, and bodies float
  bool warm_ = false;                       // whether there is a converged solution to start from
  std::unique_ptr<TangentialDrift> drift_;  // where contact alone holds bodies
  bool has_support_terms_ = true;           // whether the system has the terms of the supports
  std::string solver_error_;                // of Trilinos, where it gave up
  std::string why_fallback_;                // what multigrid gave up with
  int fallbacks_ = 0;                       // linear solves since then
};

ContactSolver::Impl::Impl(const OuterProblem& problem, const SolvedState* earlier)
    : problem_(problem),
      earlier_(earlier),
      solver_(problem.exec, problem.system, problem.scene.solver.preconditioner, problem.scene.solver.shared_unknowns,
              problem.scene.solver.method),
      now_(problem),
      right_hand_side_(problem) {
  if (now_.floating.any()) drift_ = std::make_unique<TangentialDrift>(problem.bodies, problem.supports, problem.pairs);
}

void ContactSolver::Impl::take_loads() {
  for (BodyModel& body : problem_.bodies)
    if (body.boundary.body_force_at) body.cut_cells.gather_moments();
  const std::vector<double> load = make_load_vector(problem_.bodies, problem_.system, problem_.scales);
  load_of_body_ = force_of_body(problem_.bodies, problem_.system, problem_.scales, load);
  right_hand_side_.begin(load, warm_);
}

/// From the last solution or, where that has no closed points, from few.
OuterResult ContactSolver::Impl::run(const std::function<void(const OuterStep&)>& progress) {
  take_loads();
  for (std::size_t b = 0; b < problem_.bodies.size(); ++b)
    now_.body_motions.set_expansion(b, problem_.bodies[b].expansion);
  // Closed points of another grid hold all bodies; without its displacements there is no way to search along.
  bool held = false;
  if (!warm_) {
    now_.forget();
    held = earlier_ && start_from(*earlier_, now_);
    if (!held) initialise_active_set(now_);
    earlier_ = nullptr;
  } else if (now_.floating.any() && count_active(problem_.pairs) == 0) {
    initialise_active_set(now_);  // a step without loads has opened all
  }
  slides_into_place_ = false;
  now_.friction.begin_step(now_.groups(), now_.gap_change());
  renew_friction(now_.gap_change());
  unbalanced_ = now_.floating.any() ? now_.floating.not_stopped_by_the_other_side() : FreeMotions();
  return iterate(progress, held);
}

/// Iterates; held: the closed points that it starts from hold all bodies.
OuterResult ContactSolver::Impl::iterate(const std::function<void(const OuterStep&)>& progress, bool held) {
  OuterResult result;
  result.u = now_.u;
  solver_error_.clear();
  warm_ = false;
  double outer_residual = 1;
  double tightening = 1;  // factor of the tolerances of linear solves
  ActiveSetHistory history(problem_.pairs);
  SoftContact soft(problem_.pairs);
  RealView before;
  for (int iteration = 1; may_go_on(iteration, result.residuals); ++iteration) {
    OuterStep step;
    step.iteration = iteration;
    assemble();
    if (right_hand_side_.underflows()) return stop(iteration, numbers_underflow, result);
    const bool search = (now_.floating.any() && !held) || history.cycles() || now_.friction.any();
    if (search && before.size() == 0) before = RealView("cgcontact::outer_loop::before", now_.u.size());
    if (search) Kokkos::deep_copy(before, now_.u);
    const double inner =
        std::max(tightening * std::min(settings().inner_fraction * outer_residual, settings().loosest_inner_tolerance),
                 settings().linear_tolerance);
    LinearSolveResult solve = solve_linear(inner * right_hand_side_.force_norm());
    // Displacements that are good enough as they are would give the same stresses again, converged or not.
    if (solve.iterations == 0) solve = solve_linear(settings().linear_tolerance * right_hand_side_.force_norm());
    step.linear_iterations = solve.iterations;
    result.linear_iterations.push_back(solve.iterations);
    if (!std::isfinite(solve.residual) || (!solve.converged && solve.iterations >= settings().max_linear_iterations))
      return stop(iteration, describe_linear_solve(problem_.scene, solve, solver_error_, right_hand_side_.force_norm()),
                  result);
    if (iteration == 1 && slides_at_once()) {
      begin_sliding(before);
      record(result, step, progress);
      continue;
    }
    if (search) step.length = search_along_step(solver_, before, now_);
    const double spring_force = now_.spring_force();
    // Where bodies wedge in, the balance, whose bounds do not follow the gap, multiplies errors by -mu / tan a.
    const bool rubs = now_.floating.any() && !slides_into_place_ && now_.friction.any() && now_.friction.is_released();
    const bool by_law = rubs && balance_floating_bodies(true).empty();  // else loads are beyond friction: it slides
    held = !now_.floating.any() || contact_holds_floating_bodies();
    if (unbalanced_.empty() && !held) unbalanced_ = balance_floating_bodies(by_law);
    if (!unbalanced_.empty()) {
      update_active_set(now_, false);
      return stop(iteration, describe_separation(open_separating_pairs(now_, unbalanced_), problem_.pairs.size()),
                  result);
    }
    now_.update_spring_anchors();
    if (drift_exceeded()) {
      result.drifts = true;
      return result;
    }
    update_active_set(now_, iteration <= settings().last_small_zone_decision);
    step.changed_points = history.record(problem_.pairs);
    step.residual = renew_stress();
    if (step.changed_points == 0 && step.residual > slow_fall * outer_residual) tightening *= tighter;
    outer_residual = step.residual;
    record(result, step, progress);
    if (const std::string sliding = describe_sliding(problem_, now_.floating, now_.friction.sliding());
        !sliding.empty())
      return end(iteration, sliding, result);
    const bool was_soft = soft.is_soft();
    if (!now_.friction.any()) soft.follow(step);  // whose line search is there for other reasons
    if (held && step.changed_points > 0 && !driven_motions(problem_).empty())
      return stop(iteration, describe_loss_of_contact(problem_.pairs), result);
    if (!was_soft && step.changed_points == 0 && step.residual < settings().tolerance && step.length == 1 &&
        spring_force <= std::max(settings().largest_spring_fraction * now_.total_force(),
                                 settings().linear_tolerance * right_hand_side_.force_norm() * now_.force_unit())) {
      polish(result);
      result.converged = warm_ = true;
      return result;
    }
    if (keeps_drifting(result.residuals)) {
      result.drifts = warm_ = true;
      return result;
    }
  }
  polish(result);
  result.other_cells_may_help = true;
  result.diagnosis =
      history.cycles() ? history.describe(problem_.pairs) : describe_residual(settings(), result.residuals);
  return result;
}

void ContactSolver::Impl::record(OuterResult& result, OuterStep& step,
                                 const std::function<void(const OuterStep&)>& progress) const {
  step.active_points = count_active(problem_.pairs);
  result.residuals.push_back(step.residual);
  result.active_points.push_back(step.active_points);
  result.iterations = step.iteration;
  progress(step);
}

/// Returns whether points that stick, in the first solve of a step, ask more than friction carries, while contact
/// without friction holds all bodies: wedges and what displacements drag do, blocks on inclines do not.
bool ContactSolver::Impl::slides_at_once() const {
  return now_.friction.any() && now_.friction.carries_less_than(now_.group_force(true)) &&
         (!now_.floating.any() || now_.floating.held_without_friction());
}

/// Takes the first solve of a step back: the next one has no friction, and those after it the law.
void ContactSolver::Impl::begin_sliding(const RealView& before) {
  Kokkos::deep_copy(now_.u, before);
  slides_into_place_ = now_.floating.any();
  now_.friction.slide();
  renew_friction(now_.gap_change());
}

/// Recovers the stress and, with friction, what it bounds; returns how far both are from what the last system had.
double ContactSolver::Impl::renew_stress() {
  Friction& friction = now_.friction;
  // The forces of the next solution are about those of the last one: what lagged stress changes, gaps take up.
  const RealView change = friction.any() ? now_.gap_change() : RealView();
  if (friction.any()) friction.add_forceless_gaps(now_.groups(), -1, change);
  const double changed = std::max(lagged_stress_->update(now_), now_.small_zones.relative_change());
  if (!friction.any()) return changed;
  friction.add_forceless_gaps(now_.groups(), 1, change);
  const bool released = friction.is_released();
  friction.release();
  renew_friction(change);
  return released ? std::max(changed, friction.residual()) : 1;
}

/// change: of the gaps of all rows, m.
void ContactSolver::Impl::renew_friction(const RealView& change) {
  if (now_.friction.renew(now_.groups(), change)) take_turned_rows();
}

void ContactSolver::Impl::take_turned_rows() {
  right_hand_side_.take_rows(problem_);
  now_.set_rigid_motions_aside();  // what they do to the rows
}

/// Allows more than max_outer_iterations while the residual falls: bodies that roll on an edge and friction close to
/// sliding converge slowly but surely.
bool ContactSolver::Impl::may_go_on(int iteration, const std::vector<double>& residuals) const {
  const int most = settings().max_outer_iterations;
  if (iteration <= most) return true;
  const std::size_t n = residuals.size();
  return n > falls_in && residuals[n - 1] < falls_to * residuals[n - 1 - falls_in] && iteration <= longest * most;
}

bool ContactSolver::Impl::drift_exceeded() const {
  return drift_ && drift_->farthest(now_.body_motions.of_bodies()) > max_drift;
}

/// Returns whether all else stands still, while bodies that soft springs follow do not come to rest.
bool ContactSolver::Impl::keeps_drifting(const std::vector<double>& residuals) const {
  const std::size_t n = residuals.size();
  return n > patience && residuals[n - 1] < nearly_converged && residuals[n - 1] > 0.5 * residuals[n - 3] && drift_ &&
         drift_->farthest(now_.body_motions.of_bodies()) > no_drift;
}

/// From the state of a solver of the same scene whose bodies were not held along surfaces yet.
void ContactSolver::Impl::warm_start_from(const Impl& other) {
  if (!other.warm_) return;
  now_.warm_start_from(other.now_);
  warm_ = true;
}

/// Linear system of the present iterate.
void ContactSolver::Impl::assemble() {
  set_group_stiffness(problem_.system, now_.group_stiffness());
  set_group_coupling(problem_.system, now_.group_coupling());
  now_.set_rigid_motions_aside();
  right_hand_side_.assemble(now_);
}

/// Between two set-ups of the solver the terms of the supports are only memory, and so are moments, but for body
/// forces.
void ContactSolver::Impl::update_solver() {
  if (solver_.needs_supports()) {
    for (BodyModel& body : problem_.bodies) body.cut_cells.gather_moments();
    if (!has_support_terms_)
      add_supports(problem_.scene, problem_.bodies, problem_.supports, problem_.scales, problem_.system);
  }
  solver_.update();
  problem_.system.changed_rows.clear();
  if (!lagged_stress_) lagged_stress_ = std::make_unique<LaggedStress>(problem_);
  has_support_terms_ = solver_.needs_supports();
  if (has_support_terms_) return;
  for (std::vector<SupportTerm>& terms : problem_.system.supports) terms = std::vector<SupportTerm>();
  for (BodyModel& body : problem_.bodies)
    if (!body.boundary.body_force_at) body.cut_cells.keep_own_moments();
}

/// Trilinos throws where numbers are no longer finite; its messages have many lines. Where multigrid cannot be set up
/// MueLu takes over.
LinearSolveResult ContactSolver::Impl::solve_linear(double tolerance) {
  try {
    update_solver();
    fallbacks_ += !why_fallback_.empty();
    const int most = settings().max_linear_iterations, at_first = std::min(most, solver_.patience());
    const auto solve = [&](int limit) { return solver_.solve(right_hand_side_.vector(), now_.u, tolerance, limit); };
    LinearSolveResult result = solve(at_first);
    if (result.converged || result.iterations < at_first || at_first == most) return result;
    update_solver();
    const int before = result.iterations;
    result = solve(most - before);
    result.iterations += before;
    return result;
  } catch (const std::exception& error) {
    if (is_out_of_memory(error)) throw;
    solver_error_ = error.what();
    std::replace(solver_error_.begin(), solver_error_.end(), '\n', ' ');
  }
  if (solver_.fall_back()) {
    why_fallback_ = std::exchange(solver_error_, "");
    return solve_linear(tolerance);
  }
  LinearSolveResult failed;
  failed.residual = std::numeric_limits<double>::quiet_NaN();
  return failed;
}

/// Returns whether the points that press now resist all motions that the loads drive. Zones smaller than the cells
/// press by a law that the points do not have.
bool ContactSolver::Impl::contact_holds_floating_bodies() {
  for (int k = 0; k < static_cast<int>(problem_.pairs.size()); ++k)
    if (now_.small_zones.count(k) > 0) return false;
  close_pressing_points(now_);
  return driven_motions(problem_, hardly_any_stiffness).empty();
}

void ContactSolver::Impl::end_step() { now_.friction.end_step(now_.groups(), now_.gap_change()); }

/// Moves the bodies that contact alone holds to where its forces balance the loads; with friction also those that it
/// holds, since a step along faces that slip overshoots. by_law: of friction, not by the linear forces of the last
/// solve. Returns what nothing stops.
FreeMotions ContactSolver::Impl::balance_floating_bodies(bool by_law) {
  now_.set_rigid_motions_aside();
  std::vector<double> gap = now_.group_gap_change();
  std::vector<double> stress(now_.contact_stress.h_view.extent(0));
  for (std::size_t q = 0; q < stress.size(); ++q) stress[q] = now_.contact_stress.h_view(q) * problem_.scales.stress;
  std::size_t group = 0;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactGroup& g : pair.groups) gap[group++] += g.initial_gap;
  const FloatingBodies::Balance balance = now_.floating.balance(
      gap, stress, now_.small_zones, now_.friction.laws(now_.groups(), now_.gap_change()), by_law);
  if (!balance.found) return balance.unbalanced;
  if (balance.motions.empty()) return {};
  for (std::size_t b = 0; b < balance.motions.size(); ++b) {
    const RigidComponent& component = now_.floating.components()[b];
    now_.body_motions.move(b, balance.motions[b].head<3>(), balance.motions[b].tail<3>() / component.size(),
                           component.centre());
  }
  now_.set_rigid_motions_aside();
  return {};
}

/// The force in the right-hand side exceeds that of the solution by orders: how accurate it is to be is known
/// afterwards.
Approach ContactSolver::Impl::approach(int pair) {
  if (problem_.system.groups.coupling.extent(0) > 0) {
    set_group_coupling(problem_.system, {});  // the estimate weighs by what forces do, and takes that for its transpose
    update_solver();
  }
  std::vector<double> stiffness = now_.group_stiffness();
  std::size_t first = 0;
  for (int k = 0; k < pair; ++k) first += problem_.pairs[k].groups.size();
  const std::size_t last = first + problem_.pairs[pair].groups.size();
  std::vector<double> force = stiffness;
  for (std::size_t g = 0; g < force.size(); ++g)
    if (g < first || g >= last) force[g] = 0;
  const RealView x("cgcontact::outer_loop::approach", now_.u.size());
  for (double tolerance = approach_tolerance * right_hand_side_.assemble_groups(force);;) {
    const LinearSolveResult solve =
        solver_.solve(right_hand_side_.vector(), x, tolerance, settings().max_linear_iterations);
    if (!(solve.residual <= tolerance)) return {pair, RealView(), 0, {}};
    std::vector<double> left = to_host(now_.gap_change_of(x));  // m
    for (std::size_t g = 0; g < left.size(); ++g) left[g] = force[g] - stiffness[g] * left[g] / problem_.scales.length;
    const double wanted = approach_tolerance * right_hand_side_.assemble_groups(left);
    if (tolerance <= wanted) {
      const double sum = std::accumulate(left.begin() + first, left.begin() + last, 0.0);
      return {pair, x, sum * now_.force_unit() / problem_.scales.length, {}};
    }
    tolerance = wanted;
    right_hand_side_.assemble_groups(force);
  }
}

/// Last linear solve with the final state, so that the forces are in equilibrium to the linear tolerance.
void ContactSolver::Impl::polish(OuterResult& result) {
  assemble();
  const LinearSolveResult solve = solve_linear(settings().linear_tolerance * right_hand_side_.force_norm());
  result.linear_iterations.push_back(solve.iterations);
  set_forces(result);
}

/// Not converged.
OuterResult ContactSolver::Impl::end(int iteration, const std::string& why, OuterResult result) const {
  result.iterations = iteration;
  set_forces(result);
  result.diagnosis = why;
  return result;
}

/// Not converged; names the motion that hardly anything resists, if there is one.
OuterResult ContactSolver::Impl::stop(int iteration, const std::string& why, OuterResult result) const {
  result = end(iteration, why, std::move(result));
  const FreeMotions driven = unbalanced_.empty() ? driven_motions(problem_, hardly_any_stiffness) : unbalanced_;
  if (driven.empty()) return result;
  const std::string free = find_free_motion(problem_.scene, problem_.bodies, problem_.supports, problem_.pairs);
  result.diagnosis += "; " + (free.empty() ? describe(driven, problem_.scene) : free);
  return result;
}

/// lambda = sigma* - kappa E/h (u . d - g) at supports, and the contact forces: what the last linear system contained.
void ContactSolver::Impl::set_forces(OuterResult& result) const {
  result.body_motions = now_.body_motions.of_bodies();
  result.group_force = now_.group_force(true);
  const auto first_row = result.group_force.begin() + now_.friction.first_row();
  result.friction_force.assign(first_row, result.group_force.end());
  result.group_force.erase(first_row, result.group_force.end());
  result.friction = now_.friction.state(now_.groups(), now_.gap_change());
  result.preconditioner = solver_.report();
  result.fallbacks = fallbacks_;
  result.why_fallback = why_fallback_;
  result.small_zone_groups.clear();
  result.small_zone_width.clear();
  for (int k = 0; k < static_cast<int>(problem_.pairs.size()); ++k) {
    result.small_zone_groups.push_back(now_.small_zones.count(k));
    result.small_zone_width.push_back(now_.small_zones.width(k));
  }
  result.load_of_body = load_of_body_;
  result.support_stress = now_.support_tractions();
}

ContactSolver::ContactSolver(const OuterProblem& problem, const SolvedState* earlier)
    : impl_(std::make_unique<Impl>(problem, earlier)) {}
ContactSolver::~ContactSolver() = default;

void ContactSolver::end_step() { impl_->end_step(); }

Approach ContactSolver::approach(int pair) { return impl_->approach(pair); }

void ContactSolver::warm_start_from(const ContactSolver& other) { impl_->warm_start_from(*other.impl_); }

OuterResult ContactSolver::solve(const std::function<void(const OuterStep&)>& progress) { return impl_->run(progress); }

}  // namespace cgcontact
