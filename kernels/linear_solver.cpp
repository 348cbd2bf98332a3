#include "kernels/linear_solver.hpp"

#include <BelosPseudoBlockCGSolMgr.hpp>
#include <BelosTpetraAdapter.hpp>
#include <MueLu_CreateTpetraPreconditioner.hpp>
#include <Tpetra_Core.hpp>
#include <cstdlib>

#include "kernels/assembly.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

struct LinearSolver::Impl {
  const ElasticSystem& system;
  const NearNullSpace& near_null_space;
  RCP<const TpetraMap> map;
  RCP<ElasticityOperator> op;
  RCP<TpetraOperator> preconditioner;

  Impl(const ElasticSystem& s, const NearNullSpace& n) : system(s), near_null_space(n) {
    map = make_dof_map(system, Tpetra::getDefaultComm());
    op = rcp(new ElasticityOperator(system, map));
  }

  /// Six rigid-body modes of the assembly, components in each body's grid axes.
  RCP<TpetraVector> rigid_body_modes() const {
    auto modes = rcp(new TpetraVector(map, 6));
    auto view = modes->getLocalViewHost(Tpetra::Access::OverwriteAll);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : near_null_space.position) centre += x / static_cast<double>(near_null_space.position.size());
    for (int n = 0; n < system.num_nodes; ++n) {
      const Mat3 to_local = near_null_space.axes[near_null_space.body_of_node[n]].transpose();
      const Vec3 r = near_null_space.position[n] - centre;
      for (int m = 0; m < 3; ++m) {
        const Vec3 e = Vec3::Unit(m);
        const Vec3 translation = to_local * e, rotation = to_local * e.cross(r);
        for (int i = 0; i < 3; ++i) {
          view(3 * n + i, m) = translation[i];
          view(3 * n + i, 3 + m) = rotation[i];
        }
      }
    }
    return modes;
  }

  using Coordinates = Tpetra::MultiVector<double>;
  RCP<Coordinates> coordinates() const {
    auto node_map = rcp(new TpetraMap(static_cast<Tpetra::global_size_t>(system.num_nodes), 0, map->getComm()));
    auto x = rcp(new Coordinates(node_map, 3));
    auto view = x->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (int n = 0; n < system.num_nodes; ++n)
      for (int i = 0; i < 3; ++i) view(n, i) = near_null_space.position[n][i];
    return x;
  }
};

LinearSolver::LinearSolver(const ElasticSystem& system, const NearNullSpace& near_null_space)
    : impl_(std::make_unique<Impl>(system, near_null_space)) {}
LinearSolver::~LinearSolver() = default;

bool LinearSolver::has_preconditioner() const { return !impl_->preconditioner.is_null(); }

void LinearSolver::rebuild_preconditioner() {
  impl_->preconditioner = Teuchos::null;
  RCP<TpetraOperator> matrix = assemble_matrix(impl_->system, impl_->map);
  Teuchos::ParameterList list;
  list.set("verbosity", "none");
  list.set("number of equations", 3);
  list.set("use kokkos refactor", false);
  list.set("problem: symmetric", true);
  list.set("coarse: max size", 1500);
  // Chebyshev runs on SpMV, 2-3 times faster here than Gauss-Seidel sweeps; with MueLu's default of 10 power iterations
  // the preconditioner can become indefinite (design section 5), 30 are safe.
  list.set("smoother: type", "CHEBYSHEV");
  Teuchos::ParameterList& smoother = list.sublist("smoother: params");
  smoother.set("chebyshev: degree", 3);
  smoother.set("chebyshev: ratio eigenvalue", 20.0);
  smoother.set("chebyshev: eigenvalue max iterations", 30);
  list.sublist("user data").set("Nullspace", impl_->rigid_body_modes());
  list.sublist("user data").set("Coordinates", impl_->coordinates());
  impl_->preconditioner = MueLu::CreateTpetraPreconditioner<double>(matrix, list);
}

LinearSolveResult LinearSolver::solve(const RealView& b, const RealView& x, double tolerance, int max_iterations) {
  LinearSolveResult result;
  const ExecSpace exec;
  const int n = impl_->system.num_dofs();
  auto rhs = rcp(new TpetraVector(impl_->map, 1));
  auto correction = rcp(new TpetraVector(impl_->map, 1));
  auto residual = [&] {
    const auto r = Kokkos::subview(rhs->getLocalViewDevice(Tpetra::Access::OverwriteAll), Kokkos::ALL, 0);
    impl_->system.apply(exec, x, r);
    Kokkos::parallel_for(
        "cgcontact::linear_solver::residual", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
        KOKKOS_LAMBDA(const int i) { r(i) = b(i) - r(i); });
    exec.fence();
  };
  residual();
  double norm = rhs->getVector(0)->norm2();
  // Correction form: the tolerance stays absolute however good the start is. The recursive residual may drift from the
  // true one near rounding: a second sweep corrects that.
  for (int sweep = 0; sweep < 3 && norm > tolerance && result.iterations < max_iterations; ++sweep) {
    correction->putScalar(0);
    auto problem = rcp(new Belos::LinearProblem<double, TpetraVector, TpetraOperator>(impl_->op, correction, rhs));
    if (has_preconditioner()) problem->setLeftPrec(impl_->preconditioner);
    problem->setProblem();
    auto list = rcp(new Teuchos::ParameterList);
    list->set("Convergence Tolerance", std::max(0.9 * tolerance / norm, 1e-15));
    list->set("Maximum Iterations", max_iterations - result.iterations);
    list->set("Verbosity", static_cast<int>(Belos::Errors));
    list->set("Residual Scaling", "Norm of Initial Residual");
    list->set("Implicit Residual Scaling", "Norm of Initial Residual");
    list->set("Assert Positive Definiteness", false);
    Belos::PseudoBlockCGSolMgr<double, TpetraVector, TpetraOperator> solver(problem, list);
    solver.solve();
    result.iterations += solver.getNumIters();
    const auto dx = Kokkos::subview(correction->getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
    Kokkos::parallel_for(
        "cgcontact::linear_solver::update", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
        KOKKOS_LAMBDA(const int i) { x(i) += dx(i); });
    residual();
    const double previous = norm;
    norm = rhs->getVector(0)->norm2();
    if (!(norm < 0.5 * previous)) break;
  }
  result.residual = norm;
  result.converged = norm <= tolerance;
  return result;
}

struct TrilinosScope::Impl {
  std::unique_ptr<Tpetra::ScopeGuard> guard;
};

namespace {

/// One process without mpirun: no helper daemon, no session directory, no search for networks or X displays. Starts in
/// 0.1 s instead of 0.4 s, and of 5 s on a machine that cannot resolve "localhost".
void quiet_mpi() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMIX_RANK")) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  setenv("HWLOC_HIDE_ERRORS", "2", 0);  // a container without /sys is no error here
}

}  // namespace

TrilinosScope::TrilinosScope(int threads) : impl_(std::make_unique<Impl>()) {
#if KOKKOS_VERSION >= 30700
  std::string option = "--kokkos-num-threads=" + std::to_string(threads);
#else
  std::string option = "--kokkos-threads=" + std::to_string(threads);
#endif
  std::string program = "cgcontact";
  std::string no_warnings =
      "--kokkos-disable-warnings";  // on binding and on the number of threads: the program's own task
  std::vector<char*> arguments{program.data(), no_warnings.data()};
  if (threads > 0) arguments.push_back(option.data());
  quiet_mpi();
  int argc = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  char** argv = arguments.data();
  impl_->guard = std::make_unique<Tpetra::ScopeGuard>(&argc, &argv);
}
TrilinosScope::~TrilinosScope() = default;
const char* TrilinosScope::backend() { return ExecSpace::name(); }
bool TrilinosScope::has_openmp() {
#ifdef KOKKOS_ENABLE_OPENMP
  return std::is_same_v<ExecSpace, Kokkos::OpenMP>;
#else
  return false;
#endif
}
int TrilinosScope::concurrency() { return ExecSpace::concurrency(); }

}  // namespace cgcontact
