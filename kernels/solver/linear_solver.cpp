#include "kernels/solver/linear_solver.hpp"

#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>
#include <cstdlib>

#include "core/base/parallel.hpp"
#include "kernels/assembled/muelu.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/solver/conjugate_gradients.hpp"
#include "kernels/solver/rigid_bodies.hpp"
#include "kernels/solver/rigid_coarse_space.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

namespace {

/// Iterations of one solve; more, and the rigid motions of bodies that contact alone holds are solved for beside the
/// preconditioner. With contact that coarse grids see well enough, as of one body, fewer are needed without.
constexpr int many_iterations = 30;

/// Another preconditioner, whose result is made consistent (DofMap): MueLu knows the free values only.
class Consistent : public TpetraOperator {
 public:
  Consistent(RCP<const TpetraOperator> inner, const DofMap& dofs) : inner_(std::move(inner)), dofs_(dofs) {}

  RCP<const TpetraMap> getDomainMap() const override { return inner_->getDomainMap(); }
  RCP<const TpetraMap> getRangeMap() const override { return inner_->getRangeMap(); }
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override {
    inner_->apply(X, Y, mode, alpha, beta);
    const ExecSpace exec;
    const auto y = Kokkos::subview(Y.getLocalViewDevice(Tpetra::Access::ReadWrite), Kokkos::ALL, 0);
    apply_constraints(exec, dofs_, y);
    exec.fence();
  }

 private:
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
    const RealView r(const_cast<double*>(X.getLocalViewDevice(Tpetra::Access::ReadOnly).data()), n);
    const RealView z(Y.getLocalViewDevice(Tpetra::Access::ReadWrite).data(), n);
    motions_.correct(r, z);
  }

 private:
  RCP<const TpetraOperator> inner_;
  const RigidCoarseSpace& motions_;
};

}  // namespace

struct LinearSolver::Impl {
  const ElasticSystem& system;
  Preconditioner kind;
  RigidBodies rigid_bodies;
  /// With rigid bodies from the start, else once a solve has taken many iterations.
  std::unique_ptr<RigidCoarseSpace> rigid_motions;
  MultigridSettings settings;
  RCP<const TpetraMap> map;
  RCP<ElasticityOperator> op;
  RCP<const TpetraOperator> projected_op;  ///< on the motions of rigid bodies, if there are any
  RCP<const TpetraOperator> preconditioner;
  RCP<Multigrid> multigrid;
  PreconditionerReport report;
  std::vector<double> muelu_groups;  ///< stiffness of the contact groups that MueLu was set up with

  /// A preconditioner, which leaves rigid bodies rigid.
  RCP<const TpetraOperator> on_rigid_motions(RCP<const TpetraOperator> inner) const {
    if (rigid_bodies.empty()) return inner;
    return rcp(new OnRigidMotions(std::move(inner), rigid_bodies, NodeValues::displacements));
  }

  /// From the next update on.
  void keep_rigid_motions_apart() {
    if (kind == Preconditioner::muelu || rigid_motions) return;
    auto motions = std::make_unique<RigidCoarseSpace>(system);
    if (motions->empty()) return;
    rigid_motions = std::move(motions);
    settings.firm_holds = true;
    multigrid = Teuchos::null;
  }
};

LinearSolver::LinearSolver(const ElasticSystem& system, Preconditioner preconditioner)
    : impl_(new Impl{system, preconditioner, RigidBodies(system), {}, {}, {}, {}, {}, {}, {}, {}, {}}) {
  impl_->map = system.dofs.owned_map(Tpetra::getDefaultComm());
  impl_->op = rcp(new ElasticityOperator(system, impl_->map));
  impl_->projected_op = impl_->op;
  if (impl_->rigid_bodies.empty()) return;
  impl_->projected_op = rcp(new OnRigidMotions(impl_->op, impl_->rigid_bodies, NodeValues::forces));
  impl_->keep_rigid_motions_apart();
}
LinearSolver::~LinearSolver() = default;

const PreconditionerReport& LinearSolver::report() const { return impl_->report; }

void LinearSolver::update() {
  Impl& s = *impl_;
  s.op->update_groups(s.system);
  if (s.rigid_motions) s.rigid_motions->update();
  if (s.kind == Preconditioner::muelu) {
    const std::vector<double> stiffness = group_stiffness(s.system);
    if (!s.preconditioner.is_null() && !changed_much(s.muelu_groups, stiffness)) return;
    s.preconditioner = s.on_rigid_motions(rcp(new Consistent(make_muelu(s.system, s.map), s.system.dofs)));
    s.muelu_groups = stiffness;
    ++s.report.setups;
    return;
  }
  if (s.multigrid.is_null()) {
    s.multigrid = rcp(new Multigrid(s.system, s.map, s.settings));
    s.preconditioner = s.on_rigid_motions(s.multigrid);
    if (s.rigid_motions) s.preconditioner = rcp(new WithRigidMotions(s.preconditioner, *s.rigid_motions));
  } else {
    s.multigrid->update_groups();
  }
  s.report.setups = s.multigrid->report().coarsest_setups;
  s.report.eigenvalues = s.multigrid->report().largest_eigenvalue;
  s.report.unknowns = s.multigrid->report().unknowns;
}

LinearSolveResult LinearSolver::solve(const RealView& b, const RealView& x, double tolerance, int max_iterations) {
  LinearSolveResult result;
  const ExecSpace exec;
  const int n = impl_->system.num_dofs();
  auto rhs = rcp(new TpetraVector(impl_->map, 1));
  auto correction = rcp(new TpetraVector(impl_->map, 1));
  auto residual = [&] {
    const RealView r(rhs->getLocalViewDevice(Tpetra::Access::OverwriteAll).data(), n);
    impl_->op->kernel().residual(exec, b, x, r);
    exec.fence();
    impl_->rigid_bodies.project(NodeValues::forces, r);
  };
  residual();
  const auto add_correction = [&] {
    const auto dx = Kokkos::subview(correction->getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
    Kokkos::parallel_for(
        "cgcontact::linear_solver::update", Kokkos::RangePolicy<ExecSpace>(exec, 0, n),
        KOKKOS_LAMBDA(const int i) { x(i) += dx(i); });
    residual();
  };
  if (impl_->rigid_motions) {  // in balance with the rigid motions from the start; a cycle also gives it their dents
    impl_->preconditioner->apply(*rhs, *correction, Teuchos::NO_TRANS, 1, 0);
    add_correction();
  }
  double norm = rhs->getVector(0)->norm2();
  // Correction form: the tolerance stays absolute however good the start is. The recursive residual may drift from the
  // true one near rounding: a second sweep corrects that.
  for (int sweep = 0; sweep < 3 && norm > tolerance && result.iterations < max_iterations; ++sweep) {
    correction->putScalar(0);
    const double relative = std::max(0.9 * tolerance / norm, 1e-15);
    result.iterations += conjugate_gradients(impl_->projected_op, impl_->preconditioner, rhs, correction, relative,
                                             max_iterations - result.iterations);
    add_correction();
    const double previous = norm;
    norm = rhs->getVector(0)->norm2();
    if (!(norm < 0.5 * previous)) break;
  }
  result.residual = norm;
  result.converged = norm <= tolerance;
  if (result.iterations > many_iterations) impl_->keep_rigid_motions_apart();
  return result;
}

double LinearSolver::energy(const RealView& x) const {
  const ExecSpace exec;
  const RealView zero("cgcontact::linear_solver::zero", x.size()), Ax("cgcontact::linear_solver::Ax", x.size());
  impl_->op->kernel().residual(exec, zero, x, Ax);  // -A x
  exec.fence();
  constexpr std::size_t grain = 4096;  // sums in a fixed order
  std::vector<double> parts(num_chunks(x.size(), grain), 0.0);
  parallel_chunks("cgcontact::linear_solver::energy", x.size(), grain,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) parts[chunk] -= x(i) * Ax(i);
                  });
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

struct TrilinosScope::Impl {
  explicit Impl(int threads) : kokkos(threads) {}
  KokkosScope kokkos;
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

TrilinosScope::TrilinosScope(int threads) : impl_(std::make_unique<Impl>(threads)) {
  quiet_mpi();
  std::string program = "cgcontact";
  char* arguments[] = {program.data(), nullptr};
  int argc = 1;
  char** argv = arguments;
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
