/// Geometric multigrid on the hierarchy of grids: one cycle as the preconditioner of flexible CG. Matrix-free, in
/// single precision; the bodies are coarsened separately and stay coupled through their contact rows; MueLu on the
/// assembled matrix of the coarsest level.
///
/// The cycle is a K-cycle (Y. Notay, P. S. Vassilevski, "Recursive Krylov-based multigrid cycles", Numer. Linear
/// Algebra Appl. 15, 2008): an intermediate level's correction takes up to three steps of flexible CG with the cycle of
/// the coarser levels as preconditioner, until the residual has fallen to a quarter. For solid bodies one step mostly
/// does: a V-cycle with a step length. Where cells are wider than a body is thick, two levels alone converge as well as
/// elsewhere, but a bending motion costs each of them more than the next finer one (shear locking, a factor of four),
/// and in a V-cycle these losses multiply.
///
/// Local refinement changes only some cells from grid to grid: a grid that mostly repeats the next finer one is passed
/// by where its visits could cost more than the finest grid.
#pragma once

#include <memory>
#include <vector>

#include "kernels/operator/operator.hpp"
#include "kernels/ranks/rank_share.hpp"

namespace cgcontact {

struct MultigridSettings {
  int smoother_degree = 5;
  double smoother_ratio = 16;     ///< the smoother works on the eigenvalues in [largest / ratio, largest]
  int coarse_steps = 3;           ///< steps of flexible CG on a coarse level at most; 0: V-cycle
  double coarse_residual = 0.25;  ///< their residual, relative: no further step below
  double coarse_ghost = 0.1;      ///< ghost penalty of coarse levels, in terms of that of the finest
  bool firm_holds = false;        ///< coarse grids hold firmly what contact alone holds (RigidCoarseSpace)
  int coarsest_unknowns = 1000;   ///< coarsening stops below
  /// Alternatively per body: many bodies keep more, and levels that hardly shrink cost as much as those above.
  int coarsest_unknowns_per_body = 200;
  int shared_unknowns = 20000;  ///< of several ranks: grids of more are divided, the others every rank has
};

struct MultigridReport {
  std::vector<int> unknowns;               ///< per level, finest first
  std::vector<double> largest_eigenvalue;  ///< of M^-1 A on all levels but the coarsest; 0: passed by
  std::vector<long long> cycles;           ///< per level: how often it was worked on; 0: it is passed by
  int coarsest_setups = 0;
  std::vector<int> muelu_unknowns;  ///< of MueLu's levels on the coarsest grid; one: a direct solve
};

class Multigrid : public TpetraOperator {
 public:
  /// Builds the hierarchy; the system, whole on every rank, must outlive it. Collective.
  explicit Multigrid(const ElasticSystem& system, const MultigridSettings& settings = {});
  ~Multigrid() override;

  /// Takes over the present stiffness of the contact groups on all levels: a surface-sized job.
  void update_groups();

  const MultigridReport& report() const;
  /// Returns whether the system is so small that it is the coarsest grid itself: assembled again when groups change.
  bool is_single_grid() const;

  /// Returns this rank's share of the finest grid: the vectors of apply() are in its numbers. nullptr: of the whole
  /// system, on every rank the same.
  const RankShare* share() const;
  /// Drops the cells once the operator of the finest grid has been made.
  void drop_cells();

  Teuchos::RCP<const TpetraMap> getDomainMap() const override;
  Teuchos::RCP<const TpetraMap> getRangeMap() const override;
  /// Computes Y = cycle of X; alpha = 1, beta = 0, one column. Not linear in X unless coarse_steps is 0.
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cgcontact
