#include "kernels/solver/conjugate_gradients.hpp"

#include <BelosLinearProblem.hpp>
#include <BelosTpetraAdapter.hpp>
#include <Tpetra_Vector.hpp>

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

int conjugate_gradients(const RCP<const TpetraOperator>& A, const RCP<const TpetraOperator>& preconditioner,
                        const RCP<const TpetraVector>& b, const RCP<TpetraVector>& x, double tolerance,
                        int max_iterations) {
  Belos::LinearProblem<double, TpetraVector, TpetraOperator> problem(A, x, b);
  if (!preconditioner.is_null()) problem.setLeftPrec(preconditioner);
  problem.setProblem();
  const auto dot = [](const TpetraVector& u, const TpetraVector& v) { return u.getVector(0)->dot(*v.getVector(0)); };
  TpetraVector r(b->getMap(), 1), z(b->getMap(), 1), p(b->getMap(), 1), q(b->getMap(), 1);
  problem.computeCurrResVec(&r, x.get(), b.get());
  const double enough = tolerance * r.getVector(0)->norm2();
  double energy = 0;
  for (int k = 0; k < max_iterations; ++k) {
    problem.applyLeftPrec(r, z);
    p.update(1, z, k == 0 ? 0 : -dot(z, q) / energy);
    problem.applyOp(p, q);
    energy = dot(p, q);
    if (!(energy > 0)) return k;  // not positive definite, or not finite: the caller sees the residual
    const double step = dot(p, r) / energy;
    x->update(step, p, 1);
    r.update(-step, q, 1);
    if (r.getVector(0)->norm2() <= enough) return k + 1;
  }
  return max_iterations;
}

}  // namespace cgcontact
