/// Settings of the outer iteration and of the linear solver. What each means stands in settings().
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

enum class Preconditioner {
  multigrid,  ///< geometric, on the hierarchy of grids
  muelu       ///< smoothed aggregation on the assembled matrix, for comparison
};
const std::vector<std::string>& preconditioner_names();
/// Returns its name in scenes and reports.
const std::string& name_of(Preconditioner preconditioner);

/// Methods of Belos' solver factory, by its names.
enum class LinearMethod {
  flexible_cg,  ///< our own (kernels/solver/flexible_cg.hpp)
  cg,
  block_cg,
  minres,
  gmres,
  block_gmres,
  flexible_gmres,
  bicgstab
};
const std::vector<std::string>& linear_method_names();
const std::string& name_of(LinearMethod method);

struct SolverOptions {
  LinearMethod method = LinearMethod::flexible_cg;
  Preconditioner preconditioner = Preconditioner::multigrid;
  double tolerance = 1e-6;
  int max_outer_iterations = 30;
  double linear_tolerance = 1e-10;
  int max_linear_iterations = 1000;
  bool nested = true;
  double kappa = 10;
  double ghost_penalty = 0.01;  ///< gamma
  int shared_unknowns = 20000;  ///< every rank solves smaller grids by itself

  // Constants of the method; figures in docs/decisions.md, "Supports and contact".

  /// kappa at supports of thin bodies is that many times as large.
  double thin_kappa_factor = 3;
  /// Tolerance of a linear solve, of the outer residual before it; at most `loosest_inner_tolerance`.
  double inner_fraction = 0.005, loosest_inner_tolerance = 1e-3;
  /// Fraction of the contact forces that springs which follow a motion may still take in the end.
  double largest_spring_fraction = 1e-6;
  /// Stiffness of what holds bodies while contact does not, of a support's on the smallest cells of the contact and the
  /// softest body that contact joins them to: below that of contact and the bodies, so that its rest position follows
  /// within the outer iteration.
  double soft_hold = 1e-5;
  /// Fractions of the approach that the deformation of the cells may stand for: groups join a zone smaller than the
  /// cells below the first, leave it above the second. Zones above are wider than a cell: their mean gaps give the
  /// force within 25 % (docs/theory.md).
  double small_zone_joins = 0.4, small_zone_leaves = 0.5;
  /// Outer iterations in which groups may join or leave zones smaller than the cells: later ones would not end.
  int last_small_zone_decision = 8;

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
