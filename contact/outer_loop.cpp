#include "contact/outer_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "contact/boundary_stress.hpp"
#include "core/parallel.hpp"

namespace cgcontact {
namespace {

/// Inner tolerance as a fraction of the last outer residual (multigrid.md, table I).
constexpr double inner_fraction = 0.005;
constexpr double loosest_inner_tolerance = 1e-3;
/// Forces below this part of the kappa terms, and stresses below this part of E u / h, are rounding.
constexpr double no_force = 1e-10, no_stress = 1e-9;
/// Points per chunk of the parallel loops.
constexpr std::size_t grain = 512;

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum);
}

std::vector<double> free_thickness(const std::vector<BodyModel>& bodies) {
  std::vector<double> cells;
  for (const BodyModel& body : bodies) cells.push_back(body.free_thickness);
  return cells;
}

class OuterLoop {
 public:
  explicit OuterLoop(OuterProblem& problem);
  OuterResult run(const std::function<void(const OuterStep&)>& progress);

 private:
  double support_stiffness(const SupportPoint& p) const {
    const BodySpec& body = problem_.scene.bodies[p.body];
    return support_kappa(problem_.scene, problem_.bodies[p.body]) * body.material.youngs_modulus / body.cell_size;
  }
  /// Weight (m^2) and stiffness (Pa/m) -> system units.
  double to_stiffness(double pa_per_m, double area) const {
    return pa_per_m * area / (scales().stress * scales().length);
  }
  const Scales& scales() const { return problem_.scales; }

  void initialise_active_set();
  void assemble_right_hand_side();
  std::vector<double> group_force(bool with_displacement) const;
  std::vector<double> group_stiffness() const;
  std::vector<double> group_gap_change() const;
  long long update_active_set();
  double update_recovered_stress();
  long long count_active() const;
  void polish(OuterResult& result);
  void set_forces(OuterResult& result) const;

  OuterProblem& problem_;
  LinearSolver solver_;
  std::vector<BoundaryStress> boundary_stress_;
  std::vector<double> load_, support_stress_;        // system units; units Scales::stress
  std::vector<std::vector<double>> contact_stress_;  // p* per pair and point, Scales::stress
  RealView u_, rhs_;
  double force_norm_ = 0;
};

OuterLoop::OuterLoop(OuterProblem& problem)
    : problem_(problem),
      solver_(problem.system,
              problem.scene.solver.preconditioner == "muelu" ? Preconditioner::muelu : Preconditioner::multigrid,
              free_thickness(problem.bodies)) {
  const auto cells = stabilised_cells(problem.supports, problem.pairs, problem.bodies.size());
  boundary_stress_.reserve(cells.size());
  for (std::size_t b = 0; b < cells.size(); ++b)
    boundary_stress_.emplace_back(problem.system.meshes[b], problem.patches[b], cells[b]);
  load_ = make_load_vector(problem.bodies, problem.system, problem.scales);
  support_stress_.assign(problem.supports.size(), 0.0);
  for (const ContactPair& pair : problem.pairs) contact_stress_.emplace_back(pair.points.size(), 0.0);
  u_ = RealView("cgcontact::outer_loop::u", problem.system.num_dofs());
  rhs_ = RealView("cgcontact::outer_loop::rhs", problem.system.num_dofs());
}

/// Closed at the start: all points whose gap is not positive and, if there is none, those near the smallest gap.
void OuterLoop::initialise_active_set() {
  for (ContactPair& pair : problem_.pairs) {
    double smallest = 1e300;
    for (const ContactGroup& g : pair.groups) smallest = std::min(smallest, g.initial_gap);
    const double h =
        std::min(problem_.scene.bodies[pair.primary].cell_size, problem_.scene.bodies[pair.secondary].cell_size);
    const double limit = std::max(smallest + 0.02 * h, 1e-9 * h);
    for (ContactPoint& q : pair.points) q.active = pair.groups[q.group].initial_gap <= limit;
  }
}

std::vector<double> OuterLoop::group_stiffness() const {
  std::vector<double> stiffness;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactGroup& g : pair.groups) {
      double area = 0;
      for (int q = g.first_point; q < g.last_point; ++q)
        if (pair.points[q].active) area += pair.points[q].weight;
      stiffness.push_back(to_stiffness(pair.stiffness, area));
    }
  return stiffness;
}

void OuterLoop::assemble_right_hand_side() {
  std::vector<double> f = load_, values(load_.size(), 0.0);
  const double area_scale = scales().length * scales().length;
  for (std::size_t s = 0; s < problem_.supports.size(); ++s) {
    const SupportPoint& p = problem_.supports[s];
    const Vec3 d = problem_.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
    const double stress_force = support_stress_[s] * p.weight / area_scale;
    const double value_force = to_stiffness(support_stiffness(p), p.weight) * p.value / scales().length;
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
  // Without forces (no load yet, or a motion without stress) rounding of the kappa terms is all there is to measure by.
  force_norm_ = forces > 0 ? std::max(forces, no_force * norm(f)) : 1e-2 * norm(f);
  auto host = Kokkos::create_mirror_view(rhs_);
  for (std::size_t i = 0; i < f.size(); ++i) host(i) = f[i];
  Kokkos::deep_copy(rhs_, host);
}

/// Force of each group, sum over its closed points of w (p* - kappa E/h gap): with the gap of the current displacement,
/// or with the initial gap only (the right-hand side).
std::vector<double> OuterLoop::group_force(bool with_displacement) const {
  std::vector<double> forces;
  const double area_scale = scales().length * scales().length;
  const std::vector<double> change =
      with_displacement ? group_gap_change() : std::vector<double>(problem_.system.group_rows.size(), 0.0);
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    for (const ContactGroup& g : pair.groups) {
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
std::vector<double> OuterLoop::group_gap_change() const {
  auto u = Kokkos::create_mirror_view(u_);
  Kokkos::deep_copy(u, u_);
  std::vector<double> change;
  for (const GroupRow& row : problem_.system.group_rows) {
    double sum = 0;
    for (const auto& [dof, value] : row.entries) sum += value * u(dof);
    change.push_back(sum * scales().length);
  }
  return change;
}

/// Active where p* - kappa E/h gap > 0 (p* of the previous iterate); returns the number of points that changed.
long long OuterLoop::update_active_set() {
  const std::vector<double> change = group_gap_change();
  long long changed = 0;
  std::size_t first_group = 0;
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    ContactPair& pair = problem_.pairs[k];
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      ContactPoint& point = pair.points[q];
      const double gap = pair.groups[point.group].initial_gap + change[first_group + point.group];
      const bool active = contact_stress_[k][q] * scales().stress - pair.stiffness * gap > 0;
      changed += active != point.active;
      point.active = active;
    }
    first_group += pair.groups.size();
  }
  return changed;
}

/// New sigma* at supports and contact; returns the relative change (area-weighted, L2).
double OuterLoop::update_recovered_stress() {
  for (BoundaryStress& s : boundary_stress_) s.update(u_);
  double difference = 0, norm = 0;
  const auto add = [&](double weight, double before, double after) {
    difference += weight * (after - before) * (after - before);
    norm += weight * after * after;
  };
  const auto replace = [&](std::vector<double>& values, const auto& points, const auto& stress_at) {
    std::vector<double> before(values.size());
    before.swap(values);
    parallel_for(points.size(), grain, [&](std::size_t i) { values[i] = stress_at(points[i]); });
    for (std::size_t i = 0; i < points.size(); ++i) add(points[i].weight, before[i], values[i]);
  };
  replace(support_stress_, problem_.supports, [&](const SupportPoint& p) {
    return boundary_stress_[p.body].traction(p.cell, p.xi, p.normal, p.direction);
  });
  for (std::size_t k = 0; k < problem_.pairs.size(); ++k) {
    const ContactPair& pair = problem_.pairs[k];
    replace(contact_stress_[k], pair.points, [&](const ContactPoint& c) {
      return -0.5 * (boundary_stress_[pair.primary].traction(c.primary_cell, c.primary_xi, c.normal, c.normal) +
                     boundary_stress_[pair.secondary].traction(c.secondary_cell, c.secondary_xi, c.normal, c.normal));
    });
  }
  // A motion without stress: what is recovered is rounding of E u / h, not a stress to converge to.
  double largest = 0;
  for (std::size_t i = 0; i < u_.extent(0); ++i) largest = std::max(largest, std::abs(u_(i)));
  double area = 0, stiffest = 0;
  for (const SupportPoint& p : problem_.supports) area += p.weight;
  for (const BodyMesh& mesh : problem_.system.meshes) stiffest = std::max(stiffest, mesh.stress_factor());
  norm = std::max(norm, area * std::pow(no_stress * stiffest * largest, 2));
  return norm > 0 ? std::sqrt(difference / norm) : 0.0;
}

long long OuterLoop::count_active() const {
  long long active = 0;
  for (const ContactPair& pair : problem_.pairs)
    for (const ContactPoint& q : pair.points) active += q.active;
  return active;
}

/// Last linear solve with the final state, so that the forces are in equilibrium to the linear tolerance.
void OuterLoop::polish(OuterResult& result) {
  const SolverSpec& solver = problem_.scene.solver;
  set_group_stiffness(problem_.system, group_stiffness());
  assemble_right_hand_side();
  solver_.update();
  const LinearSolveResult solve =
      solver_.solve(rhs_, u_, solver.linear_tolerance * force_norm_, solver.max_linear_iterations);
  result.linear_iterations.push_back(solve.iterations);
  set_forces(result);
}

/// lambda = sigma* - kappa E/h (u . d - g) at supports, and the contact forces: what the last linear system contained.
void OuterLoop::set_forces(OuterResult& result) const {
  result.group_force = group_force(true);
  result.load_of_body = force_of_body(problem_.bodies, problem_.system, problem_.scales, load_);
  for (std::size_t s = 0; s < problem_.supports.size(); ++s) {
    const SupportPoint& p = problem_.supports[s];
    const Vec3 d = problem_.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
    double N[8], displacement = 0;
    hex_shape(p.xi.data(), N);
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i)
        displacement += N[a] * d[i] * u_(3 * problem_.system.meshes[p.body].cell_nodes[p.cell][a] + i);
    result.support_stress.push_back(support_stress_[s] * scales().stress -
                                    support_stiffness(p) * (displacement * scales().length - p.value));
  }
}

OuterResult OuterLoop::run(const std::function<void(const OuterStep&)>& progress) {
  OuterResult result;
  result.u = u_;
  const SolverSpec& solver = problem_.scene.solver;
  initialise_active_set();
  double outer_residual = 1;
  std::set<std::vector<bool>> seen;
  int repeats = 0;
  for (int iteration = 1; iteration <= solver.max_outer_iterations; ++iteration) {
    OuterStep step;
    step.iteration = iteration;
    set_group_stiffness(problem_.system, group_stiffness());
    assemble_right_hand_side();
    const double inner = std::clamp(inner_fraction * outer_residual, solver.linear_tolerance, loosest_inner_tolerance);
    solver_.update();
    result.preconditioner_setups = solver_.report().setups;
    const LinearSolveResult solve = solver_.solve(rhs_, u_, inner * force_norm_, solver.max_linear_iterations);
    step.linear_iterations = solve.iterations;
    result.linear_iterations.push_back(solve.iterations);
    const auto stop = [&](const std::string& why) {
      result.iterations = iteration;
      set_forces(result);
      const std::string motion = find_free_motion(problem_.scene, problem_.bodies, problem_.supports, problem_.pairs);
      result.diagnosis = motion.empty() ? why : why + "; " + motion;
      return result;
    };
    if (!std::isfinite(solve.residual) || (!solve.converged && solve.iterations >= solver.max_linear_iterations))
      return stop(
          fmt::format("the linear solver stopped after {} iterations at a relative residual of {:.2e} "
                      "(solver.max_linear_iterations, solver.linear_tolerance)",
                      solve.iterations, solve.residual / force_norm_));
    step.changed_points = update_active_set();
    step.residual = update_recovered_stress();
    step.active_points = count_active();
    result.residuals.push_back(step.residual);
    result.active_points.push_back(step.active_points);
    result.iterations = iteration;
    outer_residual = step.residual;
    progress(step);
    if (step.active_points == 0 && step.changed_points > 0 && norm(load_) > 0 &&
        !find_free_motion(problem_.scene, problem_.bodies, problem_.supports, problem_.pairs).empty())
      return stop("all contact has opened and nothing else holds the bodies");
    if (step.changed_points == 0 && step.residual < solver.tolerance) {
      result.converged = true;
      polish(result);
      return result;
    }
    std::vector<bool> state;
    for (const ContactPair& pair : problem_.pairs)
      for (const ContactPoint& q : pair.points) state.push_back(q.active);
    if (step.changed_points > 0 && !seen.insert(state).second) ++repeats;
  }
  polish(result);
  result.diagnosis = repeats > 2
                         ? fmt::format("the active set cycles ({} repeated states)", repeats)
                         : fmt::format(
                               "outer residual {:.2e} after {} iterations (solver.tolerance = {:g}, "
                               "solver.max_outer_iterations = {})",
                               outer_residual, result.iterations, solver.tolerance, solver.max_outer_iterations);
  return result;
}

}  // namespace

OuterResult solve_contact(OuterProblem& problem, const std::function<void(const OuterStep&)>& progress) {
  return OuterLoop(problem).run(progress);
}

std::string find_free_motion(const Scene& scene, const std::vector<BodyModel>& bodies,
                             const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) {
  const std::size_t n = bodies.size();
  std::vector<Vec3> centre(n, Vec3::Zero());
  std::vector<double> size(n, 0.0);
  for (std::size_t b = 0; b < n; ++b) {
    const Grid& grid = bodies[b].cut_cells.grid;
    centre[b] = grid.to_global(0.5 * Vec3(grid.num_cells[0], grid.num_cells[1], grid.num_cells[2]));
    size[b] = grid.cell_size * *std::max_element(grid.num_cells.begin(), grid.num_cells.end());
  }
  // Rigid motion of body b: translation t and rotation r / size; u . d = t . d + (r x (x - c) / size) . d.
  using Row = Eigen::Matrix<double, 12, 1>;  // of one body or two
  using Matrix = Eigen::Matrix<double, 12, 12>;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  const auto set = [&](Row& row, int place, int b, const Vec3& x, const Vec3& d) {
    row.segment<3>(6 * place) = d;
    row.segment<3>(6 * place + 3) = ((x - centre[b]) / size[b]).cross(d);
  };
  std::vector<Matrix> held(n, Matrix::Zero());
  Row row = Row::Zero();
  for (const SupportPoint& p : supports) {
    const CutCells& cc = bodies[p.body].cut_cells;
    const Index3& c = cc.cells[p.cell];
    set(row, 0, p.body, cc.grid.to_global(Vec3(c[0], c[1], c[2]) + 0.5 * (p.xi + Vec3::Ones())), p.direction);
    held[p.body].noalias() += p.weight / (size[p.body] * size[p.body]) * row * row.transpose();
  }
  for (std::size_t b = 0; b < n; ++b) A.block<6, 6>(6 * b, 6 * b) += held[b].topLeftCorner<6, 6>();
  for (const ContactPair& pair : pairs) {
    Matrix sum = Matrix::Zero();
    for (const ContactPoint& q : pair.points) {
      if (!q.active) continue;
      set(row, 0, pair.primary, q.x, -q.normal);
      set(row, 1, pair.secondary, q.x, q.normal);
      sum.noalias() += q.weight / (size[pair.primary] * size[pair.primary]) * row * row.transpose();
    }
    const int body[2] = {pair.primary, pair.secondary};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) A.block<6, 6>(6 * body[i], 6 * body[j]) += sum.block<6, 6>(6 * i, 6 * j);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  if (eigen.eigenvalues()[0] > 1e-9 * eigen.eigenvalues()[6 * n - 1]) return {};
  const Eigen::VectorXd mode = eigen.eigenvectors().col(0);
  Eigen::Index largest;
  mode.cwiseAbs().maxCoeff(&largest);
  const std::size_t body = largest / 6;
  const bool rotation = largest % 6 >= 3;
  Vec3 axis = mode.segment<3>(6 * body + (rotation ? 3 : 0)).normalized();
  if (mode[largest] < 0) axis = -axis;
  axis = (1000 * axis).array().round().matrix() / 1000 + Vec3::Zero();  // three digits, and no -0
  return fmt::format("body \"{}\" is free to {} ({:.3f}, {:.3f}, {:.3f}): add a support or a contact that holds it",
                     scene.bodies[body].name, rotation ? "rotate about" : "move along", axis[0], axis[1], axis[2]);
}

}  // namespace cgcontact
