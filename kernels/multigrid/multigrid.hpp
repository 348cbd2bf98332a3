/// Geometric multigrid on the hierarchy of grids: one V-cycle as the preconditioner of CG. Matrix-free, in single
/// precision; the bodies are coarsened separately and stay coupled through their contact rows; MueLu on the assembled
/// matrix of the coarsest level.
#pragma once

#include <memory>
#include <vector>

#include "kernels/operator/operator.hpp"

namespace cgcontact {

struct MultigridSettings {
  int smoother_degree = 3;
  double smoother_ratio = 10;    ///< the smoother works on the eigenvalues in [largest / ratio, largest]
  bool soft_cells = true;        ///< softer shear and stronger smoothing where cells are wider than a body is thick
  int coarsest_unknowns = 1000;  ///< coarsening stops below
};

struct MultigridReport {
  std::vector<int> unknowns;               ///< per level, finest first
  std::vector<double> largest_eigenvalue;  ///< of M^-1 A on all levels but the coarsest
  int coarsest_setups = 0;
};

class Multigrid : public TpetraOperator {
 public:
  /// The system must outlive the hierarchy.
  Multigrid(const ElasticSystem& system, Teuchos::RCP<const TpetraMap> map, const MultigridSettings& settings = {});
  ~Multigrid() override;

  /// Takes over the present stiffness of the contact groups on all levels: a surface-sized job.
  void update_groups();

  const MultigridReport& report() const;

  Teuchos::RCP<const TpetraMap> getDomainMap() const override;
  Teuchos::RCP<const TpetraMap> getRangeMap() const override;
  /// Y = V-cycle of X; alpha = 1, beta = 0, one column.
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cgcontact
