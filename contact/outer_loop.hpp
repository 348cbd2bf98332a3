/// The outer iteration: lagged recovered stress and active set together (design section 4).
///
/// Supports: lambda = d . sigma* n - kappa E/h (u . d - g). Contact: p = [p* - kappa E/h gap]_+, the gap projected per
/// group, p* the average of both bodies' recovered normal tractions. sigma* is that of the previous outer iterate, so
/// each linear system is symmetric positive definite.
#pragma once

#include <functional>
#include <string>

#include "contact/contact_pairs.hpp"
#include "kernels/linear_solver.hpp"

namespace cgcontact {

struct OuterStep {
  int iteration = 0;
  long long active_points = 0, changed_points = 0;
  double residual = 1;
  int linear_iterations = 0;
};

struct OuterResult {
  RealView u;  ///< displacements of all bodies, Scales::length
  int iterations = 0;
  std::vector<int> linear_iterations;
  std::vector<double> residuals;
  int preconditioner_setups = 0;
  std::vector<double> support_stress;  ///< lambda of each support point, Pa
  std::vector<double> group_force;     ///< force of each contact group, Scales::stress * Scales::length^2
  bool converged = false;
  std::string diagnosis;
};

/// Everything the loop works on; references stay valid outside.
struct OuterProblem {
  const Scene& scene;
  std::vector<BodyModel>& bodies;
  const std::vector<PatchSet>& patches;
  std::vector<ContactPair>& pairs;
  const std::vector<SupportPoint>& supports;
  ElasticSystem& system;
  const Scales& scales;
};

OuterResult solve_contact(OuterProblem& problem, const std::function<void(const OuterStep&)>& progress);

}  // namespace cgcontact
