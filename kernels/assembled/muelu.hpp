/// MueLu (smoothed aggregation) on the assembled matrix of a system: the preconditioner of the coarsest level, and of
/// the whole system for comparison.
#pragma once

#include "kernels/assembled/assembly.hpp"
#include "kernels/operator/operator.hpp"

namespace cgcontact {

/// Returns the unknowns up to which MueLu factorises a matrix as it is: more in a plane, where the factors of a sparse
/// matrix hardly fill in.
int factorised_unknowns(const ElasticSystem& system);

/// Sets up MueLu on the system's assembled matrix, with the rigid-body modes of the assembly.
Teuchos::RCP<TpetraOperator> make_muelu(const ElasticSystem& system, const Teuchos::RCP<const TpetraMap>& map,
                                        const Teuchos::RCP<TpetraMatrix>& matrix);

/// Assembles the matrix as the system is now and sets up MueLu on it.
Teuchos::RCP<TpetraOperator> make_muelu(const ElasticSystem& system, const Teuchos::RCP<const TpetraMap>& map);

/// Unknowns of the levels of what make_muelu made, finest first; one: it is factorised as it is.
std::vector<int> muelu_levels(const TpetraOperator& muelu);

}  // namespace cgcontact
