/// The elastic system behind Tpetra::Operator: Y = alpha A X + beta Y, matrix-free.
#pragma once

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include "kernels/system.hpp"

namespace cgcontact {

using TpetraMap = Tpetra::Map<>;
using TpetraVector = Tpetra::MultiVector<double>;
using TpetraOperator = Tpetra::Operator<double>;

/// Map of all DoFs; one rank owns everything for now.
Teuchos::RCP<const TpetraMap> make_dof_map(const ElasticSystem& system,
                                           const Teuchos::RCP<const Teuchos::Comm<int>>& comm);

class ElasticityOperator : public TpetraOperator {
 public:
  ElasticityOperator(const ElasticSystem& system, Teuchos::RCP<const TpetraMap> map)
      : system_(system), map_(std::move(map)), product_("cgcontact::operator::product", system.num_dofs()) {}

  Teuchos::RCP<const TpetraMap> getDomainMap() const override { return map_; }
  Teuchos::RCP<const TpetraMap> getRangeMap() const override { return map_; }
  /// The operator is symmetric: mode is ignored.
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override;

 private:
  const ElasticSystem& system_;
  Teuchos::RCP<const TpetraMap> map_;
  RealView product_;
};

}  // namespace cgcontact
