/// Belos' preconditioned CG, as the linear solver and its comparison with an assembled matrix use it.
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
