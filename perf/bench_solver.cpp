/// The linear solver on the paper's scene in 3D, all contact closed: set-up of the preconditioner, solve to 1e-8.
/// Sizes are n of the scene.
///
/// Multigrid on the grids (kernels/multigrid) belongs here as well: register
///   multigrid/v_cycle     one application to a random residual; unit DoF; cost: per level 2 d + 1 operator
///   applications
///                         of its size (smoother of degree d before and after, one residual) plus the transfers;
///                         verified by the reduction of the error energy in one cycle against the plain twin's,
///   multigrid/smoother    one Chebyshev sweep on the finest level; cost: d operator applications and 5 vectors each;
///                         verified against the plain recurrence,
///   multigrid/transfer    prolongation of a linear field, exact,
/// each with the operator's Cost (bench_operator_parts.cpp) for its applications.
#include <cmath>
#include <memory>

#include "contact/postprocess.hpp"
#include "kernels/linear_solver.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

struct SolverProblem {
  SceneProblem scene;
  NearNullSpace near_null_space;
  std::unique_ptr<LinearSolver> solver;
  RealView b, x;

  explicit SolverProblem(int n) : scene("scenes/two_solids_3d.toml", {"n=" + std::to_string(n)}) {
    add_supports(scene.scene, scene.parts.supports, scene.scales, scene.system);
    std::vector<double> stiffness;
    for (const ContactPair& pair : scene.parts.pairs)
      for (const ContactGroup& group : pair.groups)
        stiffness.push_back(pair.stiffness * group.area / (scene.scales.stress * scene.scales.length));
    set_group_stiffness(scene.system, stiffness);
    for (std::size_t body = 0; body < scene.parts.bodies.size(); ++body) {
      const Grid& grid = scene.parts.bodies[body].cut_cells.grid;
      near_null_space.axes.push_back(grid.rotation);
      for (const Index3& i : scene.system.meshes[body].nodes) {
        near_null_space.position.push_back(grid.to_global(Vec3(i[0], i[1], i[2])) / scene.scales.length);
        near_null_space.body_of_node.push_back(static_cast<int>(body));
      }
    }
    solver = std::make_unique<LinearSolver>(scene.system, near_null_space);
    solver->rebuild_preconditioner();
    b = random_vector(scene.system.num_dofs(), 5);
    x = RealView("cgcontact::perf::x", scene.system.num_dofs());
  }

  static double norm(const RealView& v) {
    double sum = 0;
    for (std::size_t i = 0; i < v.extent(0); ++i) sum += v(i) * v(i);
    return std::sqrt(sum);
  }
  int solve() {
    Kokkos::deep_copy(x, 0.0);
    return solver->solve(b, x, 1e-8 * norm(b), 500).iterations;
  }
  /// |b - A x| / |b|, computed here.
  double residual() const {
    const RealView r("cgcontact::perf::r", b.extent(0));
    scene.system.apply(ExecSpace(), x, r);
    Kokkos::fence();
    for (std::size_t i = 0; i < b.extent(0); ++i) r(i) = b(i) - r(i);
    return norm(r) / norm(b);
  }
};

/// No cost model for MueLu; the unknowns per second of a whole set-up or solve.
Kernel solver(int n, bool setup) {
  auto p = std::make_shared<SolverProblem>(n);
  const int iterations = p->solve();
  Kernel k;
  k.items = p->scene.system.num_dofs();
  k.error = p->residual(), k.tolerance = 1.01e-8, k.against = "the system";
  if (setup)
    k.run = [p] { p->solver->rebuild_preconditioner(); };
  else
    k.run = [p] { p->solve(); };
  k.figures = {{"iterations", static_cast<double>(iterations)}};
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("solver/setup", [](int n) { return solver(n, true); }, {{5}, {16}});
    add("solver/solve", [](int n) { return solver(n, false); }, {{5}, {16}});
  });
}
