#include "kernels/solver/conjugate_gradients.hpp"

#include <BelosLinearProblem.hpp>
#include <BelosTpetraAdapter.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>

#include "core/base/ranks.hpp"
#include "kernels/mesh/dot.hpp"

namespace cgcontact {

using Teuchos::RCP;
using Teuchos::rcp;

namespace {

/// The first column, of this rank.
auto local_view(const TpetraVector& v) {
  return Kokkos::subview(v.getLocalViewDevice(Tpetra::Access::ReadOnly), Kokkos::ALL, 0);
}

}  // namespace

int conjugate_gradients(const RCP<const TpetraOperator>& A, const RCP<const TpetraOperator>& preconditioner,
                        const RCP<const TpetraVector>& b, const RCP<TpetraVector>& x, double tolerance,
                        int max_iterations) {
  Belos::LinearProblem<double, TpetraVector, TpetraOperator> problem(A, x, b);
  if (!preconditioner.is_null()) problem.setLeftPrec(preconditioner);
  problem.setProblem();
  const ExecSpace exec;
  const auto product = [&](const TpetraVector& u, const TpetraVector& v) {
    double sum = dot(exec, local_view(u), local_view(v));
    if (u.getMap()->isDistributed()) sum_over_ranks(&sum, 1);
    return sum;
  };
  TpetraVector r(b->getMap(), 1), z(b->getMap(), 1), p(b->getMap(), 1), q(b->getMap(), 1);
  problem.computeCurrResVec(&r, x.get(), b.get());
  const double enough = tolerance * std::sqrt(product(r, r));
  double energy = 0;
  for (int k = 0; k < max_iterations; ++k) {
    problem.applyLeftPrec(r, z);
    p.update(1, z, k == 0 ? 0 : -product(z, q) / energy);
    problem.applyOp(p, q);
    energy = product(p, q);
    if (!(energy > 0)) return k;  // not positive definite, or not finite: the caller sees the residual
    const double step = product(p, r) / energy;
    x->update(step, p, 1);
    r.update(-step, q, 1);
    if (std::sqrt(product(r, r)) <= enough) return k + 1;
  }
  return max_iterations;
}

}  // namespace cgcontact
