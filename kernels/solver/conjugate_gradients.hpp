/// Preconditioned CG on Belos' linear problem, as the linear solver and its comparison with an assembled matrix use it.
/// Flexible (Y. Notay, "Flexible conjugate gradients", SIAM J. Sci. Comput. 22, 2000, truncated to one direction): the
/// new direction is made A-orthogonal to the last one itself, which holds too where the preconditioner is not the same
/// linear map every time, as a K-cycle is not; Belos' own CG takes that for granted. Otherwise both are the same.
#pragma once

#include "kernels/operator/operator.hpp"

namespace cgcontact {

/// Improves x until |b - A x| <= tolerance times its first value, by the recursive residual; returns the iterations.
/// The preconditioner may be null.
int conjugate_gradients(const Teuchos::RCP<const TpetraOperator>& A,
                        const Teuchos::RCP<const TpetraOperator>& preconditioner,
                        const Teuchos::RCP<const TpetraVector>& b, const Teuchos::RCP<TpetraVector>& x,
                        double tolerance, int max_iterations);

}  // namespace cgcontact
