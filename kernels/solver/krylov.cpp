#include "kernels/solver/krylov.hpp"

#include <BelosSolverFactory.hpp>
#include <BelosTpetraAdapter.hpp>
#include <Teuchos_oblackholestream.hpp>
#include <algorithm>

#include "kernels/solver/flexible_cg.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

namespace {

/// Directions that GMRES keeps, then it starts again: each is a vector as long as the solution (two of the flexible
/// form). Solves of scenes take 5 to 40 iterations.
constexpr int restart_length = 50;

}  // namespace

bool is_flexible(LinearMethod method) {
  return method == LinearMethod::flexible_cg || method == LinearMethod::flexible_gmres;
}

int solve_krylov(LinearMethod method, const RCP<const TpetraOperator>& A, const RCP<const TpetraOperator>& M,
                 const RCP<const TpetraVector>& b, const RCP<TpetraVector>& x, double tolerance, int max_iterations) {
  register_flexible_cg();
  x->putScalar(0);
  const auto problem = rcp(new Belos::LinearProblem<double, TpetraVector, TpetraOperator>(A, x, b));
  // From the right: residuals are those of the system itself, and the products of all methods are between two vectors
  // of which one is zero at ghosts and constrained nodes.
  if (!M.is_null()) problem->setRightPrec(M);
  problem->setInitResVec(b);
  problem->setProblem();
  const auto list = Teuchos::parameterList();
  const auto solver = Belos::SolverFactory<double, TpetraVector, TpetraOperator>().create(name_of(method), list);
  const RCP<std::ostream> nowhere = rcp(new Teuchos::oblackholestream);
  list->set("Output Stream", nowhere);
  list->set("Verbosity", static_cast<int>(Belos::Errors));
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", max_iterations);
  if (solver->getValidParameters()->isParameter("Maximum Restarts")) {
    list->set("Num Blocks", std::min(restart_length, max_iterations));
    list->set("Maximum Restarts", max_iterations / restart_length);
  }
  solver->setParameters(list);
  solver->setProblem(problem);
  solver->solve();
  return solver->getNumIters();
}

}  // namespace cgcontact
