#include "kernels/solver/conjugate_gradients.hpp"

#include <BelosPseudoBlockCGSolMgr.hpp>
#include <BelosTpetraAdapter.hpp>

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

int conjugate_gradients(const RCP<const TpetraOperator>& A, const RCP<const TpetraOperator>& preconditioner,
                        const RCP<const TpetraVector>& b, const RCP<TpetraVector>& x, double tolerance,
                        int max_iterations) {
  auto problem = rcp(new Belos::LinearProblem<double, TpetraVector, TpetraOperator>(A, x, b));
  if (!preconditioner.is_null()) problem->setLeftPrec(preconditioner);
  problem->setProblem();
  auto list = rcp(new Teuchos::ParameterList);
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", max_iterations);
  list->set("Verbosity", static_cast<int>(Belos::Errors));
  list->set("Residual Scaling", "Norm of Initial Residual");
  list->set("Implicit Residual Scaling", "Norm of Initial Residual");
  list->set("Assert Positive Definiteness", false);
  Belos::PseudoBlockCGSolMgr<double, TpetraVector, TpetraOperator> solver(problem, list);
  solver.solve();
  return solver.getNumIters();
}

}  // namespace cgcontact
