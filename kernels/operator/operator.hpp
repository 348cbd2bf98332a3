/// Elastic system behind Tpetra::Operator: Y = alpha A X + beta Y, matrix-free.
#pragma once

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include "kernels/operator/fast_operator.hpp"

namespace cgcontact {

using TpetraMap = Tpetra::Map<>;
using TpetraVector = Tpetra::MultiVector<double>;
using TpetraOperator = Tpetra::Operator<double>;

class ElasticityOperator : public TpetraOperator {
 public:
  /// `map`: DofMap::vector_map of the system.
  ElasticityOperator(const ElasticSystem& system, Teuchos::RCP<const TpetraMap> map)
      : operator_(system), map_(std::move(map)) {}

  /// Takes over the present stiffness of the contact groups.
  void update_groups(const ElasticSystem& system) { operator_.set_groups(system); }
  const FastOperator<double>& kernel() const { return operator_; }

  Teuchos::RCP<const TpetraMap> getDomainMap() const override { return map_; }
  Teuchos::RCP<const TpetraMap> getRangeMap() const override { return map_; }
  /// Applies the operator, which is symmetric: mode is ignored.
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override;

 private:
  FastOperator<double> operator_;
  Teuchos::RCP<const TpetraMap> map_;
};

}  // namespace cgcontact
