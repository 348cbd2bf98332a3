/// The linear solve by a method of Belos' solver factory, as the linear solver and its comparison with an assembled
/// matrix use it.
#pragma once

#include "core/settings/solver_options.hpp"
#include "kernels/operator/operator.hpp"

namespace cgcontact {

/// Returns whether the method allows a preconditioner that is not the same linear map every time, as a K-cycle.
bool is_flexible(LinearMethod method);

/// Solves for x, from zero, until |b - A x| <= tolerance |b| as the method measures it: by its recursive residual,
/// MINRES by the true one. Returns the iterations; its quality follows from x. Belos prints nothing. A, M symmetric
/// positive definite; M may be null. For a method that is not flexible M has to be the same linear map every time.
/// Throws exceptions of Belos where it finds out that they are not.
int solve_krylov(LinearMethod method, const Teuchos::RCP<const TpetraOperator>& A,
                 const Teuchos::RCP<const TpetraOperator>& M, const Teuchos::RCP<const TpetraVector>& b,
                 const Teuchos::RCP<TpetraVector>& x, double tolerance, int max_iterations);

}  // namespace cgcontact
