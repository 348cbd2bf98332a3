/// Belos CG on the matrix-free operator, preconditioned by MueLu on the assembled matrix (design section 5).
#pragma once

#include <memory>
#include <vector>

#include "kernels/system.hpp"

namespace cgcontact {

/// What MueLu needs to know of each node: position and the rigid-body modes in the node's own axes.
struct NearNullSpace {
  std::vector<Vec3> position;  ///< per node, units of Scales::length, global axes
  std::vector<Mat3> axes;      ///< per body: columns are the grid axes
  std::vector<int> body_of_node;
};

struct LinearSolveResult {
  int iterations = 0;
  double residual = 0;  ///< absolute, recomputed with the operator
  bool converged = false;
};

class LinearSolver {
 public:
  /// The system and the near-null space must outlive the solver.
  LinearSolver(const ElasticSystem& system, const NearNullSpace& near_null_space);
  ~LinearSolver();

  /// Assembles the matrix as the system is now and sets up MueLu on it.
  void rebuild_preconditioner();
  bool has_preconditioner() const;

  /// Improves x until |b - A x| <= tolerance (absolute, Euclidean). b, x: num_dofs entries.
  LinearSolveResult solve(const RealView& b, const RealView& x, double tolerance, int max_iterations);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Starts Kokkos and Tpetra (and MPI underneath) once, stops them at the end of its life. threads = 0: the backend's
/// default.
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
