/// The same system as an assembled matrix, for MueLu.
#pragma once

#include <Tpetra_CrsMatrix.hpp>

#include "kernels/operator/operator.hpp"

namespace cgcontact {

using TpetraMatrix = Tpetra::CrsMatrix<double>;

/// Assembles the matrix of the system on the given map; equals the matrix-free operator to rounding.
Teuchos::RCP<TpetraMatrix> assemble_matrix(const ElasticSystem& system, const Teuchos::RCP<const TpetraMap>& map);

}  // namespace cgcontact
