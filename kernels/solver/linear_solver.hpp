/// Flexible CG, or another method of Belos, on the matrix-free operator (flexible GMRES where rows are coupled),
/// preconditioned by geometric multigrid or, for comparison, by MueLu on the assembled matrix.
#pragma once

#include <memory>
#include <vector>

#include "core/settings/solver_options.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

struct PreconditionerReport {
  int setups = 0;                   ///< of MueLu: on the whole system, or on the coarsest level
  std::vector<int> unknowns;        ///< multigrid: per level, finest first
  std::vector<long long> cycles;    ///< multigrid: how often each level was worked on
  std::vector<int> muelu_unknowns;  ///< of MueLu's own levels, finest first; one: a direct solve
  std::vector<double> eigenvalues;  ///< multigrid: largest of the smoothed operator, per level
};

struct LinearSolveResult {
  int iterations = 0;
  double residual = 0;  ///< absolute, recomputed with the operator
  bool converged = false;
};

class LinearSolver {
 public:
  /// The system must outlive the solver; every rank has it whole; all functions are collective. Grids of more than
  /// `shared_unknowns` are divided among the ranks (-1: MultigridSettings); with MueLu every rank solves the whole. A
  /// method that takes the preconditioner for the same linear map every time has a V-cycle instead of the K-cycle.
  /// exec: what kernels run on.
  LinearSolver(const ExecSpace& exec, const ElasticSystem& system, Preconditioner preconditioner,
               int shared_unknowns = -1, LinearMethod method = LinearMethod::flexible_cg);
  ~LinearSolver();

  /// Updates the stiffness of the contact groups; the first call sets the preconditioner up (multigrid follows changes,
  /// MueLu is set up anew for large ones).
  void update();
  /// Switches to MueLu from the next update on, if the preconditioner is multigrid; false: it is MueLu already.
  bool fall_back();
  /// Iterations of a solve after which another update finds a better preconditioner.
  int patience() const;
  /// Returns whether the next update reads the supports of the system. Between two that do not, they may be left out.
  bool needs_supports() const;
  /// Figures of all solves so far.
  PreconditionerReport report() const;

  /// Improves x until |b - A x| <= tolerance (absolute, Euclidean). b, x: num_dofs entries.
  LinearSolveResult solve(const RealView& b, const RealView& x, double tolerance, int max_iterations);

  /// Returns x . A x, after an update.
  double energy(const RealView& x) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Starts Kokkos and Tpetra (and MPI underneath) unless they run, and stops them at the end of its life. threads = 0:
/// the backend's default. Collective.
class TrilinosScope {
 public:
  explicit TrilinosScope(int threads);
  ~TrilinosScope();
  static const char* backend();  ///< name of the default execution space
  static bool has_openmp();
  static int concurrency();  ///< number of threads

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cgcontact
