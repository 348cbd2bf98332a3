/// Outer iteration: lagged recovered stress and active set together.
///
/// Supports: lambda = d . sigma* n - kappa E/h (u . d - g). Contact: p = [p* - kappa E/h gap]_+, the gap projected per
/// group, p* the weighted mean of both bodies' recovered pressures. sigma* is that of the previous outer iterate, so
/// each linear system is symmetric positive definite but where friction slips.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "contact/solve/floating/body_motion.hpp"
#include "contact/solve/forces/friction.hpp"
#include "contact/solve/forces/small_zones.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {

struct OuterStep {
  int iteration = 0;
  long long active_points = 0, changed_points = 0;
  double residual = 1;
  double length = 1;  ///< fraction of the step that a line search left
  int linear_iterations = 0;
};

struct OuterResult {
  RealView u;  ///< displacements of all bodies less their rigid motions, Scales::length; the next call overwrites them
  std::vector<BodyMotion> body_motions;  ///< of each body
  int iterations = 0;
  std::vector<int> linear_iterations;
  std::vector<double> residuals;
  std::vector<long long> active_points;             ///< closed, after each iteration
  std::vector<Vec3> load_of_body;                   ///< resultant of loads and body forces, N
  PreconditionerReport preconditioner;              ///< of all solves of the ContactSolver
  int fallbacks = 0;                                ///< linear solves preconditioned by MueLu because multigrid gave up
  std::string why_fallback;                         ///< what it gave up with
  std::vector<double> support_stress;               ///< lambda of each support point, Pa
  std::vector<double> group_force;                  ///< force of each contact group, Scales::stress * Scales::length^2
  std::vector<double> friction_force;               ///< of each row of friction, the same
  std::vector<FrictionPoints> friction;             ///< of each pair
  std::vector<int> small_zone_groups;               ///< of each pair: that press by a zone smaller than the cells
  std::vector<SmallZones::Width> small_zone_width;  ///< of each pair: of such zones
  bool converged = false;
  bool other_cells_may_help = false;  ///< it ran out of iterations, or a contact was lost
  bool lost_contact = false;          ///< a force is left that balances nothing
  /// Stopped because a body drifts along surfaces: to be held (tangential_drift.hpp), and solved again.
  bool drifts = false;
  std::string diagnosis;
};

/// What the bodies do when a pair's faces approach each other by Scales::length without loads, closed points as they
/// are: its force is wrong by products of this solution's errors and the other one's. Nothing is lagged: the contact's
/// stiffness kappa E/h gives way a little.
struct Approach {
  int pair = 0;
  RealView u;            ///< less rigid motions, Scales::length; empty: the linear solver failed, or it is estimated
  double stiffness = 0;  ///< force of the pair over the approach, N/m
  std::vector<std::vector<double>> error_of_cell;  ///< estimates by body and active cell (EnergySums)
};

struct SolvedState;

/// Solves one system under changing loads, prescribed displacements and gaps (those of the bodies, supports and pairs
/// at each call): the second and later calls start from the solution before, if that converged.
class ContactSolver {
 public:
  /// earlier: a solution on other grids that the first call starts from (outer_start.hpp), or none.
  explicit ContactSolver(const OuterProblem& problem, const SolvedState* earlier = nullptr);
  ~ContactSolver();
  /// Starts from where a solver stopped that found a body to drift (`drifts`); from nothing, if it was far off.
  void warm_start_from(const ContactSolver& other);
  OuterResult solve(const std::function<void(const OuterStep&)>& progress);
  /// Solves for the approach of a pair's faces, after a solution; without estimates.
  Approach approach(int pair);
  /// Ends a load step: from now on points stick where friction has let them slip to.
  void end_step();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cgcontact
