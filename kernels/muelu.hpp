/// MueLu (smoothed aggregation) on the assembled matrix of a system: the preconditioner of the coarsest level, and of
/// the whole system for comparison.
#pragma once

#include "kernels/operator.hpp"

namespace cgcontact {

/// Assembles the matrix as the system is now and sets up MueLu on it, with the rigid-body modes of the assembly.
Teuchos::RCP<TpetraOperator> make_muelu(const ElasticSystem& system, const Teuchos::RCP<const TpetraMap>& map);

}  // namespace cgcontact
