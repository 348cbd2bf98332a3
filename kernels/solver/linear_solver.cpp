#include "kernels/solver/linear_solver.hpp"

#include <Teuchos_TimeMonitor.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/process/memory.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/assembled/muelu.hpp"
#include "kernels/mesh/dot.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/solver/flexible_cg.hpp"
#include "kernels/solver/krylov.hpp"
#include "kernels/solver/rigid_bodies.hpp"
#include "kernels/solver/rigid_coarse_space.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

namespace {

/// Iterations of one solve above which the rigid motions of bodies that contact alone holds are solved for beside the
/// preconditioner. With contact that coarse grids see well, as of one body, fewer are needed without. A solve is
/// stopped at twice as many: without the motions it may not end.
constexpr int many_iterations = 30;

/// Adds the cycles on the levels of another hierarchy of the same grids.
void add_cycles(const std::vector<long long>& more, std::vector<long long>& cycles) {
  cycles.resize(std::max(cycles.size(), more.size()), 0);
  for (std::size_t l = 0; l < more.size(); ++l) cycles[l] += more[l];
}

/// Another preconditioner, whose result is made consistent (DofMap): MueLu knows the free values only.
class Consistent : public TpetraOperator {
 public:
  Consistent(const ExecSpace& exec, RCP<const TpetraOperator> inner, const DofMap& dofs)
      : exec_(exec), inner_(std::move(inner)), dofs_(dofs) {}

  RCP<const TpetraMap> getDomainMap() const override { return inner_->getDomainMap(); }
  RCP<const TpetraMap> getRangeMap() const override { return inner_->getRangeMap(); }
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override {
    inner_->apply(X, Y, mode, alpha, beta);
    const auto y = Kokkos::subview(Y.getLocalViewDevice(Tpetra::Access::ReadWrite), Kokkos::ALL, 0);
    apply_constraints(exec_, dofs_, y);
    exec_.fence();
  }

 private:
  ExecSpace exec_;
  RCP<const TpetraOperator> inner_;
  const DofMap& dofs_;
};

/// A preconditioner with the rigid motions of bodies that no support holds solved for beside it.
class WithRigidMotions : public TpetraOperator {
 public:
  WithRigidMotions(RCP<const TpetraOperator> inner, const RigidCoarseSpace& motions)
      : inner_(std::move(inner)), motions_(motions) {}

  RCP<const TpetraMap> getDomainMap() const override { return inner_->getDomainMap(); }
  RCP<const TpetraMap> getRangeMap() const override { return inner_->getRangeMap(); }
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override {
    inner_->apply(X, Y, mode, alpha, beta);
    const auto n = static_cast<std::size_t>(X.getLocalLength());
    const RigidCoarseSpace::Forces r(X.getLocalViewDevice(Tpetra::Access::ReadOnly).data(), n);
    const RealView z(Y.getLocalViewDevice(Tpetra::Access::ReadWrite).data(), n);
    motions_.correct(r, z);
  }

 private:
  RCP<const TpetraOperator> inner_;
  const RigidCoarseSpace& motions_;
};

}  // namespace

struct LinearSolver::Impl {
  ExecSpace exec;
  const ElasticSystem& system;
  Preconditioner kind;
  LinearMethod method;
  RigidBodies rigid_bodies;
  /// With rigid bodies from the start, else once a solve has taken many iterations.
  std::unique_ptr<RigidCoarseSpace> rigid_motions = {};
  MultigridSettings settings = {};
  RCP<const TpetraMap> map = {};
  RCP<ElasticityOperator> op = {};
  RCP<const TpetraOperator> projected_op = {};  ///< on the motions of rigid bodies, if there are any
  RCP<const TpetraOperator> preconditioner = {};
  RCP<Multigrid> multigrid = {};
  PreconditionerReport report = {};
  std::vector<double> muelu_groups = {};  ///< stiffness of the contact groups that MueLu was set up with
  bool renew = false;                     ///< another hierarchy at the next update
  bool wants_motions = false;             ///< the next update looks for rigid motions to be kept apart
  bool has_no_motions = false;            ///< it has looked, and there are none

  /// Unsymmetric where rows are coupled.
  LinearMethod method_for_rows() const {
    return system.groups.coupling.extent(0) > 0 ? LinearMethod::flexible_gmres : method;
  }

  const RankShare* share() const { return multigrid.is_null() ? nullptr : multigrid->share(); }
  /// Returns the system that this rank computes.
  const ElasticSystem& own_system() const { return share() ? share()->system() : system; }

  /// A preconditioner, which leaves rigid bodies rigid.
  RCP<const TpetraOperator> on_rigid_motions(RCP<const TpetraOperator> inner) const {
    if (rigid_bodies.empty()) return inner;
    return rcp(new OnRigidMotions(std::move(inner), rigid_bodies, NodeValues::displacements));
  }

  bool may_keep_motions_apart() const { return kind != Preconditioner::muelu && !rigid_motions && !has_no_motions; }
  /// From the next update on.
  void keep_rigid_motions_apart() { wants_motions = may_keep_motions_apart(); }

  void look_for_rigid_motions() {
    if (!std::exchange(wants_motions, false)) return;
    auto motions = std::make_unique<RigidCoarseSpace>(exec, system);
    has_no_motions = motions->empty();
    if (has_no_motions) return;
    rigid_motions = std::move(motions);
    settings.firm_holds = true;
    renew = true;
  }

  void make_muelu_preconditioner() {
    if (map.is_null()) map = system.dofs.vector_map(comm_of_this_rank());
    const std::vector<double> stiffness = group_stiffness(system);
    if (!preconditioner.is_null() && !changed_much(muelu_groups, stiffness)) return;
    const RCP<TpetraOperator> muelu = make_muelu(system, map);
    preconditioner = on_rigid_motions(rcp(new Consistent(exec, muelu, system.dofs)));
    muelu_groups = stiffness;
    ++report.setups;
    report.muelu_unknowns = muelu_levels(*muelu);
  }

  /// Its work stays in the report.
  void drop_multigrid() {
    if (multigrid.is_null()) return;
    report.setups += multigrid->report().coarsest_setups;
    add_cycles(multigrid->report().cycles, report.cycles);
    multigrid = Teuchos::null;
  }

  void make_multigrid() {
    if (std::exchange(renew, false)) {
      op = Teuchos::null;
      drop_multigrid();
    }
    if (!multigrid.is_null()) return multigrid->update_groups();
    multigrid = rcp(new Multigrid(system, settings));
    map = multigrid->getDomainMap();
    preconditioner = on_rigid_motions(multigrid);
    if (share()) share()->record_counts();
    if (!rigid_motions) return;
    if (share()) rigid_motions->set_share(*share());
    preconditioner = rcp(new WithRigidMotions(preconditioner, *rigid_motions));
  }

  LinearSolveResult solve(const RealView& b, const RealView& x, double tolerance, int max_iterations);
};

/// With rigid bodies every rank solves the whole.
LinearSolver::LinearSolver(const ExecSpace& exec, const ElasticSystem& system, Preconditioner preconditioner,
                           int shared_unknowns, LinearMethod method)
    : impl_(new Impl{exec, system, preconditioner, method, RigidBodies(exec, system)}) {
  if (!is_flexible(method)) impl_->settings.coarse_steps = 0;
  if (shared_unknowns >= 0) impl_->settings.shared_unknowns = shared_unknowns;
  if (impl_->rigid_bodies.empty()) return;
  impl_->settings.shared_unknowns = std::numeric_limits<int>::max();
  impl_->keep_rigid_motions_apart();
}
LinearSolver::~LinearSolver() = default;

PreconditionerReport LinearSolver::report() const {
  PreconditionerReport report = impl_->report;
  if (impl_->multigrid.is_null()) return report;
  const MultigridReport now = impl_->multigrid->report();
  report.setups += now.coarsest_setups;
  report.unknowns = now.unknowns;
  report.eigenvalues = now.largest_eigenvalue;
  add_cycles(now.cycles, report.cycles);
  report.muelu_unknowns = now.muelu_unknowns;
  return report;
}

void LinearSolver::update() {
  Impl& s = *impl_;
  s.look_for_rigid_motions();
  if (s.kind == Preconditioner::muelu) {
    s.make_muelu_preconditioner();
  } else {
    s.make_multigrid();
  }
  if (s.rigid_motions) s.rigid_motions->update();
  if (!s.op.is_null()) return s.op->update_groups(s.own_system());
  s.op = rcp(new ElasticityOperator(s.own_system(), s.map));
  s.projected_op = s.op;
  if (!s.rigid_bodies.empty()) s.projected_op = rcp(new OnRigidMotions(s.op, s.rigid_bodies, NodeValues::forces));
  if (!s.multigrid.is_null()) s.multigrid->drop_cells();
  return_freed_memory();
}

bool LinearSolver::fall_back() {
  Impl& s = *impl_;
  if (s.kind == Preconditioner::muelu) return false;
  s.kind = Preconditioner::muelu;
  s.projected_op = s.op = Teuchos::null;
  s.preconditioner = Teuchos::null;
  s.drop_multigrid();
  s.rigid_motions.reset();
  s.wants_motions = s.renew = false;
  s.map = Teuchos::null;
  return true;
}

int LinearSolver::patience() const {
  return impl_->may_keep_motions_apart() ? 2 * many_iterations : std::numeric_limits<int>::max();
}

bool LinearSolver::needs_supports() const {
  return impl_->multigrid.is_null() || impl_->renew || impl_->wants_motions || impl_->multigrid->is_single_grid();
}

LinearSolveResult LinearSolver::solve(const RealView& b, const RealView& x, double tolerance, int max_iterations) {
  const RankShare* share = impl_->share();
  if (!share) return impl_->solve(b, x, tolerance, max_iterations);
  const auto n = static_cast<std::size_t>(share->system().num_dofs());
  const RealView own_b("cgcontact::linear_solver::own_b", n), own_x("cgcontact::linear_solver::own_x", n);
  share->to_local(b, own_b);
  share->to_local(x, own_x);
  zero_others(impl_->exec, share->system().dofs, own_b);
  const LinearSolveResult result = impl_->solve(own_b, own_x, tolerance, max_iterations);
  share->to_whole(own_x, x);
  apply_constraints(impl_->exec, impl_->system.dofs, x);
  Kokkos::fence();
  return result;
}

LinearSolveResult LinearSolver::Impl::solve(const RealView& b, const RealView& x, double tolerance,
                                            int max_iterations) {
  LinearSolveResult result;
  const int n = own_system().num_dofs();
  auto rhs = rcp(new TpetraVector(map, 1));
  auto correction = rcp(new TpetraVector(map, 1));
  auto residual = [&] {
    const RealView r(rhs->getLocalViewDevice(Tpetra::Access::OverwriteAll).data(), n);
    op->kernel().residual(exec, b, x, r);
    exec.fence();
    rigid_bodies.project(NodeValues::forces, r);
  };
  residual();
  const auto add_correction = [&] {
    const auto dx = Kokkos::subview(correction->getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
    Kokkos::parallel_for(
        "cgcontact::linear_solver::update", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
        KOKKOS_LAMBDA(const int i) { x(i) += dx(i); });
    residual();
  };
  if (rigid_motions) {  // in balance with the rigid motions from the start; a cycle also gives it their dents
    preconditioner->apply(*rhs, *correction, Teuchos::NO_TRANS, 1, 0);
    add_correction();
  }
  double norm = std::sqrt(ordered_product(*rhs, *rhs));
  // Correction form: the tolerance stays absolute however good the start is. The recursive residual may drift from the
  // true one near rounding: a second sweep corrects that.
  for (int sweep = 0; sweep < 3 && norm > tolerance && result.iterations < max_iterations; ++sweep) {
    const double relative = std::max(0.9 * tolerance / norm, 1e-15);
    result.iterations += solve_krylov(method_for_rows(), projected_op, preconditioner, rhs, correction, relative,
                                      max_iterations - result.iterations);
    add_correction();
    const double previous = norm;
    norm = std::sqrt(ordered_product(*rhs, *rhs));
    if (!(norm < 0.5 * previous)) break;
  }
  result.residual = norm;
  result.converged = norm <= tolerance;
  if (result.iterations > many_iterations) keep_rigid_motions_apart();
  return result;
}

double LinearSolver::energy(const RealView& whole) const {
  const ExecSpace& exec = impl_->exec;
  const RankShare* share = impl_->share();
  RealView x = whole;
  if (share) {
    x = RealView("cgcontact::linear_solver::own_x", share->system().num_dofs());
    share->to_local(whole, x);
  }
  const RealView zero("cgcontact::linear_solver::zero", x.size()), Ax("cgcontact::linear_solver::Ax", x.size());
  impl_->op->kernel().residual(exec, zero, x, Ax);  // -A x
  double sum = -dot(exec, x, Ax);
  if (share) sum_over_ranks(&sum, 1);
  return sum;
}

struct TrilinosScope::Impl {
  explicit Impl(int threads) : kokkos(threads) {}
  KokkosScope kokkos;
  std::unique_ptr<Tpetra::ScopeGuard> guard;
  std::unique_ptr<RankScope> ranks;
};

namespace {

/// One process without mpirun: no helper daemon, no session directory, no search for networks or X displays. Starts in
/// 0.1 s instead of 0.4 s, and of 5 s on a machine that cannot resolve "localhost".
void quiet_mpi() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMIX_RANK") || std::getenv("PMI_RANK")) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  setenv("OMPI_MCA_btl", "self", 0);
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  setenv("HWLOC_HIDE_ERRORS", "2", 0);  // a container without /sys is no error here
}

}  // namespace

TrilinosScope::TrilinosScope(int threads) {
  if (Tpetra::isInitialized()) return;
  impl_ = std::make_unique<Impl>(threads);
  quiet_mpi();
  std::string program = "cgcontact";
  char* arguments[] = {program.data(), nullptr};
  int argc = 1;
  char** argv = arguments;
  impl_->guard = std::make_unique<Tpetra::ScopeGuard>(&argc, &argv);
  impl_->ranks = std::make_unique<RankScope>();
  Teuchos::TimeMonitor::setStackedTimer(Teuchos::null);  // it prints a warning where timers do not nest
  agree_on_memory();
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
