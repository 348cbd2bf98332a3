/// Flexible CG as a solver manager of Belos, which its factory makes under the name "FLEXIBLE CG". Y. Notay, "Flexible
/// conjugate gradients", SIAM J. Sci. Comput. 22, 2000, truncated to one direction: the new direction is made
/// A-orthogonal to the last one itself, which Belos' own CG does only if the preconditioner is the same linear map
/// every time, as a K-cycle is not. Otherwise both are the same. Scalar products are ordered_product's, so that results
/// do not depend on the number of threads.
#pragma once

#include <BelosLinearProblem.hpp>
#include <BelosOutputManager.hpp>
#include <BelosSolverManager.hpp>
#include <BelosStatusTestGenResNorm.hpp>
#include <BelosStatusTestMaxIters.hpp>
#include <BelosTpetraAdapter.hpp>

#include "kernels/operator/operator.hpp"

namespace cgcontact {

/// Returns x . y of vectors of one column, bitwise the same on any number of threads. Collective: one of the two is
/// zero at ghosts.
double ordered_product(const TpetraVector& x, const TpetraVector& y);

/// Iteration on the current right-hand side of a linear problem, from its initial residual.
class FlexibleCgIter : public Belos::Iteration<double, TpetraVector, TpetraOperator> {
 public:
  using Problem = Belos::LinearProblem<double, TpetraVector, TpetraOperator>;
  using StatusTest = Belos::StatusTest<double, TpetraVector, TpetraOperator>;

  /// Keeps `test`, which ends the iteration; it is asked before each step.
  FlexibleCgIter(Teuchos::RCP<Problem> problem, Teuchos::RCP<StatusTest> test);

  void initialize() override;
  /// Iterates until the test passes or a direction has no positive energy (broke_down).
  void iterate() override;
  /// Returns whether the operator is not positive definite to rounding, or a number is not finite.
  bool broke_down() const { return broke_down_; }
  double residual_norm() const;

  int getNumIters() const override { return iterations_; }
  void resetNumIters(int iterations = 0) override { iterations_ = iterations; }
  /// Sets norms of the recursive residual; returns no vector, whose norm Belos would sum in any order.
  Teuchos::RCP<const TpetraVector> getNativeResiduals(std::vector<double>* norms) const override;
  /// Returns null: the solution is up to date after each step.
  Teuchos::RCP<TpetraVector> getCurrentUpdate() const override { return Teuchos::null; }
  const Problem& getProblem() const override { return *problem_; }
  int getBlockSize() const override { return 1; }
  /// Throws std::invalid_argument unless size is 1.
  void setBlockSize(int size) override;
  bool isInitialized() override { return !residual_.is_null(); }

 private:
  void precondition(const TpetraVector& r, TpetraVector& z) const;

  Teuchos::RCP<Problem> problem_;
  Teuchos::RCP<StatusTest> test_;
  Teuchos::RCP<TpetraVector> residual_, preconditioned_, direction_, product_;  ///< product_: A direction_
  int iterations_ = 0;
  double energy_ = 0;
  bool broke_down_ = false;
};

class FlexibleCgSolMgr : public Belos::SolverManager<double, TpetraVector, TpetraOperator> {
 public:
  using Problem = FlexibleCgIter::Problem;
  using Manager = Belos::SolverManager<double, TpetraVector, TpetraOperator>;

  FlexibleCgSolMgr();
  Teuchos::RCP<Manager> clone() const override { return Teuchos::rcp(new FlexibleCgSolMgr); }

  /// Lists the parameters: "Convergence Tolerance" (of the residual, relative to the initial one), "Maximum
  /// Iterations", "Verbosity", "Output Style", "Output Frequency", "Output Stream", "Timer Label".
  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters() const override;
  Teuchos::RCP<const Teuchos::ParameterList> getCurrentParameters() const override { return parameters_; }
  /// Sets the parameters in the list; others stay. Throws Teuchos' exceptions for unknown parameters and wrong types.
  void setParameters(const Teuchos::RCP<Teuchos::ParameterList>& parameters) override;

  const Problem& getProblem() const override { return *problem_; }
  void setProblem(const Teuchos::RCP<Problem>& problem) override { problem_ = problem; }
  void reset(Belos::ResetType type) override;

  /// Solves for each right-hand side, in turn, from the problem's initial guess. Throws std::invalid_argument unless
  /// the problem is set.
  Belos::ReturnType solve() override;

  /// Iterations of all right-hand sides of the last solve; the largest of their relative residuals.
  int getNumIters() const override { return iterations_; }
  double achievedTol() const override { return achieved_; }
  bool isLOADetected() const override { return false; }

 private:
  using MaxIters = Belos::StatusTestMaxIters<double, TpetraVector, TpetraOperator>;
  using ResidualNorm = Belos::StatusTestGenResNorm<double, TpetraVector, TpetraOperator>;

  bool solve_column(int column);

  Teuchos::RCP<Problem> problem_;
  Teuchos::RCP<Teuchos::ParameterList> parameters_;
  Teuchos::RCP<Belos::OutputManager<double>> printer_;
  Teuchos::RCP<Teuchos::Time> timer_;
  int iterations_ = 0;
  double achieved_ = 0;
};

/// Makes "FLEXIBLE CG" known to Belos::SolverFactory; more than once is as once.
void register_flexible_cg();

}  // namespace cgcontact
