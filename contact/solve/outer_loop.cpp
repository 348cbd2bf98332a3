#include "contact/solve/outer_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "contact/motions/free_motion.hpp"
#include "contact/motions/free_pieces.hpp"
#include "contact/solve/active_set_history.hpp"
#include "contact/solve/boundary_stress.hpp"
#include "contact/solve/rigid_contact.hpp"
#include "contact/solve/small_zones.hpp"
#include "core/base/memory.hpp"
#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

/// Inner tolerance as a fraction of the last outer residual (docs/decisions.md).
constexpr double inner_fraction = 0.005;
constexpr double loosest_inner_tolerance = 1e-3;
/// Forces below this part of the kappa terms, and stresses below this part of E u / h, are rounding.
constexpr double no_force = 1e-10, no_stress = 1e-9;
/// Motions that are resisted by less than this part of the rest are named when the solver fails: a body on one small
/// curved contact is as good as free.
constexpr double hardly_any_stiffness = 1e-3;
/// Of Young's moduli: worth a question where the linear solver gives up.
constexpr double large_ratio = 1e7;
/// Iterations over which the pace of the residual is taken; the default of kappa is 10.
constexpr std::size_t pace = 4;
constexpr double small_kappa = 1;
/// Of the contact forces: what springs that follow a motion may still take.
constexpr double most_hold = 1e-6;
constexpr int most_bisections = 30;
/// Outer iterations in which groups may join or leave zones smaller than the cells.
constexpr int last_decision = 8;
/// Points per chunk of the parallel loops.
constexpr std::size_t grain = 512;

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum);
}

const char* const all_open = "all contact has opened and nothing else holds the bodies";

std::string describe_open(const std::vector<std::string>& contacts) {
  return fmt::format("contact {} has opened wholly, and nothing else holds the body", fmt::join(contacts, ", "));
}

RealView::HostMirror host_copy(const RealView& u) {
  auto host = Kokkos::create_mirror_view(u);
  Kokkos::deep_copy(host, u);
  return host;
}

}  // namespace

struct ContactSolver::Impl {
  explicit Impl(const OuterProblem& problem);
  OuterResult run(const std::function<void(const OuterStep&)>& progress);
  OuterResult iterate(const std::function<void(const OuterStep&)>& progress);

  double support_stiffness(const SupportPoint& p) const {
    return cgcontact::support_stiffness(problem_.scene, problem_.bodies[p.body]);
  }
  /// Weight (m^2) and stiffness (Pa/m) -> system units.
  double to_stiffness(double pa_per_m, double area) const {
    return pa_per_m * area / (scales().stress * scales().length);
  }
  const Scales& scales() const { return problem_.scales; }

  void forget();
  void initialise_active_set();
  bool close_near_the_smallest_gap(double allowance);
  FreeMotions driven_motions(double no_stiffness = 1e-9) const;
  void assemble_right_hand_side();
  std::vector<double> group_force(bool with_displacement) const;
  std::vector<double> group_stiffness() const;
  std::vector<double> group_gap_change() const;
  void set_rigid_parts_aside();
  double rigid_displacement(const SupportPoint& p) const;
  double displacement_of(const SupportPoint& p, const RealView::HostMirror& u) const;
  double search_along_step(const RealView& before);
  bool balance_floating_bodies();
  double force_of_followers() const;
  double total_force() const;
  void follow();
  void update_active_set(const std::vector<double>& gap_change, bool decide);
  std::vector<char> led_pairs() const;
  double update_recovered_stress();
  long long count_active() const;
  std::string describe_loss_of_contact() const;
  std::string open_what_parts();
  std::string describe_residual(const OuterResult& result) const;
  std::string describe_linear_solve(const LinearSolveResult& solve) const;
  LinearSolveResult solve_linear(double tolerance);
  void polish(OuterResult& result);
  void set_forces(OuterResult& result) const;

  OuterProblem problem_;
  LinearSolver solver_;
  std::vector<BoundaryStress> boundary_stress_;
  std::vector<double> load_, support_stress_;        // system units; units Scales::stress
  std::vector<std::vector<double>> contact_stress_;  // p* per pair and point, Scales::stress
  RealView u_, rhs_;                                 // u_: without the rigid parts
  RigidParts rigid_parts_;
  FloatingBodies floating_;
  SmallZones small_zones_;
  FreeMotions unbalanced_;                // what the loads drive without end
  std::vector<double> rigid_gap_change_;  // m, of each contact group
  double force_norm_ = 0, kappa_norm_ = 0;
  bool warm_ = false;         // is there a converged solution to start from?
  std::string solver_error_;  // of Trilinos, where it gave up
};

ContactSolver::Impl::Impl(const OuterProblem& problem)
    : problem_(problem),
      solver_(problem.system,
              problem.scene.solver.preconditioner == "muelu" ? Preconditioner::muelu : Preconditioner::multigrid),
      rigid_parts_(problem.system.meshes, problem.scales),
      floating_(problem.bodies, problem.supports, problem.pairs),
      small_zones_(problem.bodies, problem.pairs, led_pairs()) {
  const auto cells = stabilised_cells(problem.supports, problem.pairs, problem.bodies.size());
  boundary_stress_.reserve(cells.size());
  for (std::size_t b = 0; b < cells.size(); ++b)
    boundary_stress_.emplace_back(problem.system.meshes[b], problem.patches[b], cells[b]);
  u_ = RealView("cgcontact::outer_loop::u", problem.system.num_dofs());
  rhs_ = RealView("cgcontact::outer_loop::rhs", problem.system.num_dofs());
}

/// Back to no displacement and no stress.
void ContactSolver::Impl::forget() {
  Kokkos::deep_copy(u_, 0.0);
  rigid_parts_.forget();
  rigid_gap_change_.assign(problem_.system.group_rows.size(), 0.0);
  kappa_norm_ = 0;
  support_stress_.assign(problem_.supports.size(), 0.0);
  small_zones_.forget();
  contact_stress_.clear();
  for (const ContactPair& pair : problem_.pairs) contact_stress_.emplace_back(pair.points.size(), 0.0);
  for (SupportPoint& p : problem_.supports)
    if (p.follows) p.value = 0;
}

/// Of each pair: do the supports of both bodies hold them?
std::vector<char> ContactSolver::Impl::led_pairs() const {
  std::vector<char> led;
  for (const ContactPair& pair : problem_.pairs)
    led.push_back(!floating_.floats(pair.primary) && !floating_.floats(pair.secondary));
  return led;
}

/// Closes all points whose gap is not positive and, where a pair has none, those whose gap is larger than its smallest
/// one by no more than `allowance` of the smaller cell. Are all points closed?
bool ContactSolver::Impl::close_near_the_smallest_gap(double allowance) {
  bool all = true;
  for (ContactPair& pair : problem_.pairs) {
    double smallest = 1e300;
    for (const ContactGroup& g : pair.groups) smallest = std::min(smallest, g.initial_gap);
    const double h =
        std::min(problem_.scene.bodies[pair.primary].cell_size, problem_.scene.bodies[pair.secondary].cell_size);
    const double limit = std::max(smallest + allowance * h, 1e-9 * h);
    for (ContactPoint& q : pair.points) all &= q.active = pair.groups[q.group].initial_gap <= limit;
  }
  return all;
}

/// Closed at the start: where bodies meet that loads alone press together; else as few points as hold them against the
/// loads.
void ContactSolver::Impl::initialise_active_set() {
  if (floating_.any() && close_where_rigid_bodies_meet(problem_.bodies, problem_.supports, problem_.pairs)) return;
  for (double allowance = 0.02; !close_near_the_smallest_gap(allowance) && !driven_motions().empty(); allowance *= 4) {
  }
}

FreeMotions ContactSolver::Impl::driven_motions(double no_stiffness) const {
  const FreeMotions free = find_free_motions(problem_.bodies, problem_.supports, problem_.pairs, no_stiffness);
  return free.empty() ? free : driven_by_loads(free, problem_.bodies);
}

std::vector<double> ContactSolver::Impl::group_stiffness() const {
  std::vector<double> stiffness;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactGroup& g : pair.groups) {
      if (small_zones_.has(stiffness.size())) {
        stiffness.push_back(small_zones_.stiffness(stiffness.size()) / (scales().stress * scales().length));
        continue;
      }
      double area = 0;
      for (int q = g.first_point; q < g.last_point; ++q)
        if (pair.points[q].active) area += pair.points[q].weight;
      stiffness.push_back(to_stiffness(pair.stiffness, area));
    }
  return stiffness;
}

void ContactSolver::Impl::assemble_right_hand_side() {
  std::vector<double> f = load_, values(load_.size(), 0.0);
  const double area_scale = scales().length * scales().length;
  for (std::size_t s = 0; s < problem_.supports.size(); ++s) {
    const SupportPoint& p = problem_.supports[s];
    const Vec3 d = problem_.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
    const double stress_force = support_stress_[s] * p.weight / area_scale;
    const double value = p.value - rigid_displacement(p);
    const double value_force = to_stiffness(support_stiffness(p), p.weight) * value / scales().length;
    double N[8];
    hex_shape(p.xi.data(), N);
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i) {
        const int dof = 3 * problem_.system.meshes[p.body].cell_nodes[p.cell][a] + i;
        f[dof] += N[a] * d[i] * stress_force;
        values[dof] += N[a] * d[i] * value_force;
      }
  }
  // Scale of the linear tolerance: the real forces. The terms kappa E/h (prescribed displacement or gap) are larger by
  // orders and nearly cancel against the solution's; they serve only while no stress is known.
  const double forces = norm(f);
  const std::vector<double> force = group_force(false);
  for (std::size_t row = 0; row < force.size(); ++row)
    for (const auto& [dof, value] : problem_.system.group_rows[row].entries) f[dof] += value * force[row];
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += values[i];
  // Without forces (no load yet, or a motion without stress) rounding of the kappa terms is all there is to measure by:
  // what they were before rigid motions were set aside.
  kappa_norm_ = std::max(kappa_norm_, norm(f));
  force_norm_ = forces > 0 ? std::max(forces, no_force * kappa_norm_) : 1e-2 * kappa_norm_;
  auto host = Kokkos::create_mirror_view(rhs_);
  for (std::size_t i = 0; i < f.size(); ++i) host(i) = f[i];
  Kokkos::deep_copy(rhs_, host);
}

/// Force of each group, sum over its closed points of w (p* - kappa E/h gap): with the gap of the current displacement,
/// or without that of the deformation (the right-hand side).
std::vector<double> ContactSolver::Impl::group_force(bool with_displacement) const {
  std::vector<double> forces;
  const double area_scale = scales().length * scales().length;
  const std::vector<double> change = with_displacement ? group_gap_change() : rigid_gap_change_;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    for (const ContactGroup& g : pair.groups) {
      if (small_zones_.has(forces.size())) {
        const double force = small_zones_.force(forces.size(), g.initial_gap + change[forces.size()]);
        forces.push_back(force / (scales().stress * area_scale));
        continue;
      }
      const double gap = (g.initial_gap + change[forces.size()]) / scales().length;
      double force = 0;
      for (int q = g.first_point; q < g.last_point; ++q)
        if (pair.points[q].active)
          force += contact_stress_[k][q] * pair.points[q].weight / area_scale -
                   to_stiffness(pair.stiffness, pair.points[q].weight) * gap;
      forces.push_back(force);
    }
  }
  return forces;
}

/// Change of the mean gap of every group, m.
std::vector<double> ContactSolver::Impl::group_gap_change() const {
  auto u = Kokkos::create_mirror_view(u_);
  Kokkos::deep_copy(u, u_);
  std::vector<double> change;
  for (const GroupRow& row : problem_.system.group_rows) {
    double sum = 0;
    for (const auto& [dof, value] : row.entries) sum += value * u(dof);
    change.push_back(sum * scales().length + rigid_gap_change_[change.size()]);
  }
  return change;
}

/// From u_ into rigid_parts_, and what follows for the gaps.
void ContactSolver::Impl::set_rigid_parts_aside() {
  rigid_parts_.set_aside(u_);
  const std::vector<GroupRow>& rows = problem_.system.group_rows;
  parallel_for("cgcontact::outer_loop::rigid_gap_change", rows.size(), grain, [&](std::size_t r) {
    double sum = 0;
    for (const auto& [dof, value] : rows[r].entries) sum += value * rigid_parts_.at_dof(dof);
    rigid_gap_change_[r] = sum;
  });
}

/// Along the support's direction, m.
double ContactSolver::Impl::rigid_displacement(const SupportPoint& p) const {
  return p.direction.dot(
      rigid_parts_.of_bodies()[p.body].at(global_position(problem_.bodies[p.body].cut_cells, p.cell, p.xi)));
}

/// Along the support's direction, m; `u` on the host.
double ContactSolver::Impl::displacement_of(const SupportPoint& p, const RealView::HostMirror& u) const {
  const Vec3 d = problem_.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
  double N[8], displacement = rigid_displacement(p) / scales().length;
  hex_shape(p.xi.data(), N);
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i)
      displacement += N[a] * d[i] * u(3 * problem_.system.meshes[p.body].cell_nodes[p.cell][a] + i);
  return displacement * scales().length;
}

/// The linear system minimises the energy with the contact that is closed; open points that the step closes, and closed
/// ones that it opens, bend it: goes from `before` as far towards u_ as the energy
///   u . K u / 2 - f . u + sum over contact points of w [p* - k gap]_+^2 / (2 k)
/// falls, so that the active set cannot cycle while p* stays. Returns the part of the step, 1 if whole.
double ContactSolver::Impl::search_along_step(const RealView& before) {
  const RealView step("cgcontact::outer_loop::step", u_.size());
  parallel_for("cgcontact::outer_loop::step", u_.size(), 4096, [&](std::size_t i) { step(i) = u_(i) - before(i); });
  const double curvature = solver_.energy(step);
  struct Group {
    const ContactPair* pair;
    const ContactGroup* group;
    std::size_t first;       // of the pair, in the list of groups
    double gap, gap_change;  // at `before`, along the step, m
  };
  const double area_scale = scales().length * scales().length;
  std::vector<Group> groups;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactGroup& group : pair.groups) {
      double at_start = 0, along = 0;
      const bool linear = small_zones_.has(groups.size());  // their part of the energy is in the system's as it is
      for (const auto& [dof, value] : problem_.system.group_rows[groups.size()].entries) {
        if (linear) break;
        at_start += value * before(dof);
        along += value * step(dof);
      }
      groups.push_back({&pair, &group, static_cast<std::size_t>(&pair - problem_.pairs.data()),
                        group.initial_gap + rigid_gap_change_[groups.size()] + at_start * scales().length,
                        along * scales().length});
    }
  // Of the energy along the step; system units.
  const auto slope = [&](double t) {
    double sum = -curvature * (1 - t);
    for (const Group& g : groups) {
      if (g.gap_change == 0) continue;
      double more = 0;  // force of all points that press less that of those taken for closed
      for (int q = g.group->first_point; q < g.group->last_point; ++q) {
        const ContactPoint& point = g.pair->points[q];
        const double force =
            contact_stress_[g.first][q] * point.weight / area_scale -
            to_stiffness(g.pair->stiffness, point.weight) * (g.gap + t * g.gap_change) / scales().length;
        more += std::max(force, 0.0) - (point.active ? force : 0.0);
      }
      sum -= more * g.gap_change / scales().length;
    }
    return sum;
  };
  if (slope(1) <= 0) return 1;
  double low = 0, high = 1;
  for (int k = 0; k < most_bisections; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) <= 0 ? low : high) = middle;
  }
  parallel_for("cgcontact::outer_loop::go_along_step", u_.size(), 4096,
               [&](std::size_t i) { u_(i) = before(i) + high * step(i); });
  return high;
}

/// Moves the bodies that contact alone holds to where its forces balance the loads. False: nothing stops one.
bool ContactSolver::Impl::balance_floating_bodies() {
  set_rigid_parts_aside();
  std::vector<double> gap = group_gap_change();
  std::vector<std::vector<double>> stress = contact_stress_;
  std::size_t group = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    for (const ContactGroup& g : problem_.pairs[k].groups) gap[group++] += g.initial_gap;
    for (double& s : stress[k]) s *= scales().stress;
  }
  const FloatingBodies::Balance balance = floating_.balance(gap, stress);
  unbalanced_ = balance.unbalanced;
  if (!balance.found) return false;
  for (std::size_t b = 0; b < balance.motions.size(); ++b) {
    const RigidPiece& piece = floating_.pieces()[b];
    rigid_parts_.move(b, balance.motions[b].head<3>(), balance.motions[b].tail<3>() / piece.size(), piece.centre());
  }
  set_rigid_parts_aside();
  return true;
}

/// Of all contact groups, N.
double ContactSolver::Impl::total_force() const {
  double sum = 0;
  for (const double force : group_force(true)) sum += std::abs(force);
  return sum * scales().stress * scales().length * scales().length;
}

/// Sum of the magnitudes of the forces in springs that follow a motion, N.
double ContactSolver::Impl::force_of_followers() const {
  double sum = 0;
  if (!floating_.any()) return sum;
  const auto u = host_copy(u_);
  for (const SupportPoint& p : problem_.supports)
    if (p.follows) sum += std::abs(p.weight * support_stiffness(p) * (displacement_of(p, u) - p.value));
  return sum;
}

/// Where a motion is held by springs that follow it.
void ContactSolver::Impl::follow() {
  const bool any =
      std::any_of(problem_.supports.begin(), problem_.supports.end(), [](const SupportPoint& p) { return p.follows; });
  if (!any) return;
  const auto u = host_copy(u_);
  for (SupportPoint& p : problem_.supports)
    if (p.follows) p.value = displacement_of(p, u);
}

/// Active where p* - kappa E/h gap > 0 (p* of the previous iterate). Where all of a pair is rounding of kappa E/h times
/// the displacements (bodies that touch without force) nothing changes. decide: also which groups lie in zones smaller
/// than the cells. change: of the mean gaps, m.
void ContactSolver::Impl::update_active_set(const std::vector<double>& change, bool decide) {
  std::vector<double> force = group_force(true);
  for (double& f : force) f *= scales().stress * scales().length * scales().length;
  const double moved = rigid_parts_.largest_displacement(u_) * scales().length;
  std::size_t first_group = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    ContactPair& pair = problem_.pairs[k];
    const auto pressure = [&](std::size_t q) {
      const int g = pair.points[q].group;
      return contact_stress_[k][q] * scales().stress -
             pair.stiffness * (pair.groups[g].initial_gap + change[first_group + g]);
    };
    double largest = 0;
    for (std::size_t q = 0; q < pair.points.size(); ++q) largest = std::max(largest, std::abs(pressure(q)));
    if (!(largest < no_force * pair.stiffness * moved))
      for (std::size_t q = 0; q < pair.points.size(); ++q) pair.points[q].active = pressure(q) > 0;
    first_group += pair.groups.size();
  }
  small_zones_.update(change, force, decide);
}

/// New sigma* at supports and contact; returns the relative change (area-weighted, L2).
double ContactSolver::Impl::update_recovered_stress() {
  for (BoundaryStress& s : boundary_stress_) s.update(u_);
  double difference = 0, norm = 0;
  const auto add = [&](double weight, double before, double after) {
    difference += weight * (after - before) * (after - before);
    norm += weight * after * after;
  };
  const auto replace = [&](std::vector<double>& values, const auto& points, const auto& stress_at) {
    std::vector<double> before(values.size());
    before.swap(values);
    parallel_for("cgcontact::outer_loop::recovered_stress", points.size(), grain,
                 [&](std::size_t i) { values[i] = stress_at(points[i]); });
    for (std::size_t i = 0; i < points.size(); ++i) add(points[i].weight, before[i], values[i]);
  };
  replace(support_stress_, problem_.supports, [&](const SupportPoint& p) {
    if (p.support < 0) return 0.0;  // carries no force: there is no stress to lag
    return boundary_stress_[p.body].traction(p.cell, p.xi, p.normal, p.direction);
  });
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    // The softer body's counts more, as in the stiffness: the other one's changes more with the gap, and what is lagged
    // would converge slowly.
    const double first = stabilising_modulus(problem_.scene.bodies[pair.primary].material),
                 second = stabilising_modulus(problem_.scene.bodies[pair.secondary].material);
    const double part = second / (first + second);
    replace(contact_stress_[k], pair.points, [&](const ContactPoint& c) {
      return -part * boundary_stress_[pair.primary].traction(c.primary_cell, c.primary_xi, c.normal, c.normal) -
             (1 - part) *
                 boundary_stress_[pair.secondary].traction(c.secondary_cell, c.secondary_xi, c.normal, c.normal);
    });
  }
  // A motion without stress: what is recovered is rounding of E u / h, not a stress to converge to.
  const double largest = rigid_parts_.largest_displacement(u_);
  double area = 0, stiffest = 0;
  for (const SupportPoint& p : problem_.supports) area += p.weight;
  for (const BodyMesh& mesh : problem_.system.meshes) stiffest = std::max(stiffest, mesh.stress_factor());
  norm = std::max(norm, area * std::pow(no_stress * stiffest * largest, 2));
  return norm > 0 ? std::sqrt(difference / norm) : 0.0;
}

long long ContactSolver::Impl::count_active() const {
  long long active = 0;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactPoint& q : pair.points) active += q.active;
  return active;
}

/// Why nothing holds a body any more.
std::string ContactSolver::Impl::describe_loss_of_contact() const {
  if (count_active() == 0) return all_open;
  std::vector<std::string> opened;
  for (const ContactPair& pair : problem_.pairs)
    if (std::none_of(pair.points.begin(), pair.points.end(), [](const ContactPoint& q) { return q.active; }))
      opened.push_back('"' + pair.spec->name + '"');
  return opened.empty() ? "the contact that is left closed does not hold the bodies" : describe_open(opened);
}

/// Opens the pairs that part as the loads move the bodies that contact does not balance; says so.
std::string ContactSolver::Impl::open_what_parts() {
  const std::vector<char> open = floating_.pairs_that_open(unbalanced_);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (!open[k]) continue;
    names.push_back('"' + problem_.pairs[k].spec->name + '"');
    for (ContactPoint& q : problem_.pairs[k].points) q.active = false;
  }
  if (names.empty()) return "the loads push a body out of its contact";
  return names.size() == open.size() ? all_open : describe_open(names);
}

/// Where the iteration stood when it was cut off.
std::string ContactSolver::Impl::describe_residual(const OuterResult& result) const {
  const SolverSpec& solver = problem_.scene.solver;
  const std::vector<double>& r = result.residuals;
  std::string text = fmt::format(
      "outer residual {:.2e} after {} iterations (solver.tolerance = {:g}, solver.max_outer_iterations = {})", r.back(),
      result.iterations, solver.tolerance, solver.max_outer_iterations);
  if (r.size() > pace) {
    const double factor = std::pow(r.back() / r[r.size() - 1 - pace], 1.0 / pace);
    text += factor < 1 ? fmt::format("; it fell by a factor {:.2g} per iteration", factor) : "; it does not fall";
  }
  if (solver.kappa < small_kappa)
    text += fmt::format("; solver.kappa = {:g} is small: this iteration converges the faster the larger it is",
                        solver.kappa);
  return text;
}

/// Trilinos throws where numbers are no longer finite; its messages have many lines.
LinearSolveResult ContactSolver::Impl::solve_linear(double tolerance) {
  try {
    solver_.update();
    return solver_.solve(rhs_, u_, tolerance, problem_.scene.solver.max_linear_iterations);
  } catch (const std::exception& error) {
    if (is_out_of_memory(error)) throw;
    solver_error_ = error.what();
    std::replace(solver_error_.begin(), solver_error_.end(), '\n', ' ');
  }
  LinearSolveResult failed;
  failed.residual = std::numeric_limits<double>::quiet_NaN();
  return failed;
}

std::string ContactSolver::Impl::describe_linear_solve(const LinearSolveResult& solve) const {
  if (!solver_error_.empty()) return "the linear solver failed: " + solver_error_;
  if (!std::isfinite(solve.residual))
    return "numbers overflow: a load, a prescribed displacement or a modulus is out of all proportion";
  std::string text = fmt::format(
      "the linear solver stopped after {} iterations at a relative residual of {:.2e} "
      "(solver.max_linear_iterations, solver.linear_tolerance)",
      solve.iterations, solve.residual / force_norm_);
  const auto softer = [](const BodySpec& a, const BodySpec& b) {
    return a.material.youngs_modulus < b.material.youngs_modulus;
  };
  const auto [soft, stiff] = std::minmax_element(problem_.scene.bodies.begin(), problem_.scene.bodies.end(), softer);
  const double ratio = stiff->material.youngs_modulus / soft->material.youngs_modulus;
  if (ratio > large_ratio)
    text +=
        fmt::format("; E of \"{}\" is {:.1g} times that of \"{}\": is a unit wrong?", stiff->name, ratio, soft->name);
  return text;
}

/// Last linear solve with the final state, so that the forces are in equilibrium to the linear tolerance.
void ContactSolver::Impl::polish(OuterResult& result) {
  set_group_stiffness(problem_.system, group_stiffness());
  set_rigid_parts_aside();
  assemble_right_hand_side();
  const LinearSolveResult solve = solve_linear(problem_.scene.solver.linear_tolerance * force_norm_);
  result.linear_iterations.push_back(solve.iterations);
  set_forces(result);
}

/// lambda = sigma* - kappa E/h (u . d - g) at supports, and the contact forces: what the last linear system contained.
void ContactSolver::Impl::set_forces(OuterResult& result) const {
  result.rigid_parts = rigid_parts_.of_bodies();
  result.support_stress.clear();
  result.group_force = group_force(true);
  result.small_zone_groups.clear();
  result.small_zone_width.clear();
  for (int k = 0; k < static_cast<int>(problem_.pairs.size()); ++k) {
    result.small_zone_groups.push_back(small_zones_.count(k));
    result.small_zone_width.push_back(small_zones_.width(k));
  }
  result.load_of_body = force_of_body(problem_.bodies, problem_.system, problem_.scales, load_);
  const auto u = host_copy(u_);
  for (std::size_t s = 0; s < problem_.supports.size(); ++s) {
    const SupportPoint& p = problem_.supports[s];
    result.support_stress.push_back(support_stress_[s] * scales().stress -
                                    support_stiffness(p) * (displacement_of(p, u) - p.value));
  }
}

/// From the last solution or, without one, from few closed points.
OuterResult ContactSolver::Impl::run(const std::function<void(const OuterStep&)>& progress) {
  load_ = make_load_vector(problem_.bodies, problem_.system, problem_.scales);
  if (!warm_) {
    forget();
    initialise_active_set();
  }
  unbalanced_ = floating_.any() ? floating_.not_stopped_by_the_other_side() : FreeMotions();
  return iterate(progress);
}

OuterResult ContactSolver::Impl::iterate(const std::function<void(const OuterStep&)>& progress) {
  OuterResult result;
  result.u = u_;
  solver_error_.clear();
  const SolverSpec& solver = problem_.scene.solver;
  warm_ = false;
  double outer_residual = 1;
  ActiveSetHistory history(problem_.pairs);
  const RealView before("cgcontact::outer_loop::before", u_.size());
  for (int iteration = 1; iteration <= solver.max_outer_iterations; ++iteration) {
    OuterStep step;
    step.iteration = iteration;
    set_group_stiffness(problem_.system, group_stiffness());
    set_rigid_parts_aside();
    assemble_right_hand_side();
    const double inner = std::clamp(inner_fraction * outer_residual, solver.linear_tolerance, loosest_inner_tolerance);
    const bool search = floating_.any() || history.cycles();
    if (search) Kokkos::deep_copy(before, u_);
    const LinearSolveResult solve = solve_linear(inner * force_norm_);
    result.preconditioner_setups = solver_.report().setups;
    step.linear_iterations = solve.iterations;
    result.linear_iterations.push_back(solve.iterations);
    const auto stop = [&](const std::string& why) {
      result.iterations = iteration;
      set_forces(result);
      result.diagnosis = why;
      const FreeMotions driven = unbalanced_.empty() ? driven_motions(hardly_any_stiffness) : unbalanced_;
      if (driven.empty()) return result;
      const std::string free = find_free_motion(problem_.scene, problem_.bodies, problem_.supports, problem_.pairs);
      result.diagnosis += "; " + (free.empty() ? describe(driven, problem_.scene) : free);
      return result;
    };
    if (!std::isfinite(solve.residual) || (!solve.converged && solve.iterations >= solver.max_linear_iterations))
      return stop(describe_linear_solve(solve));
    const auto not_in_balance = [&] {
      update_active_set(group_gap_change(), false);
      return stop(open_what_parts());
    };
    const double length = search ? search_along_step(before) : 1;
    const double spring_force = force_of_followers();
    if (floating_.any() && (!unbalanced_.empty() || !balance_floating_bodies())) return not_in_balance();
    follow();
    update_active_set(group_gap_change(), iteration <= last_decision);
    step.changed_points = history.record(problem_.pairs);
    step.residual = std::max(update_recovered_stress(), small_zones_.relative_change());
    step.active_points = count_active();
    result.residuals.push_back(step.residual);
    result.active_points.push_back(step.active_points);
    result.iterations = iteration;
    outer_residual = step.residual;
    progress(step);
    if (step.changed_points > 0 && !driven_motions().empty()) return stop(describe_loss_of_contact());
    if (step.changed_points == 0 && step.residual < solver.tolerance && length == 1 &&
        spring_force <= most_hold * total_force()) {
      polish(result);
      result.converged = warm_ = true;
      return result;
    }
  }
  polish(result);
  result.diagnosis = history.cycles() ? history.describe(problem_.pairs) : describe_residual(result);
  return result;
}

ContactSolver::ContactSolver(const OuterProblem& problem) : impl_(std::make_unique<Impl>(problem)) {}
ContactSolver::~ContactSolver() = default;

OuterResult ContactSolver::solve(const std::function<void(const OuterStep&)>& progress) { return impl_->run(progress); }

}  // namespace cgcontact
