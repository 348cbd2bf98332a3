/// Messages on why the outer iteration ended without convergence.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/floating/rigid_contact.hpp"
#include "contact/solve/forces/outer_problem.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {

/// All that acts is so small that its squares are lost.
constexpr const char* numbers_underflow =
    "numbers underflow: loads and prescribed displacements are so small that nothing can be computed with them";

/// Describes why nothing holds a body any more, from the present state of the contact points.
std::string describe_loss_of_contact(const std::vector<ContactPair>& pairs);

/// Describes contacts that opened (names in `opened`, of `num_pairs` in all) as the loads moved the bodies.
std::string describe_separation(const std::vector<std::string>& opened, std::size_t num_pairs);

/// Describes the residual at which the iteration was cut off.
std::string describe_residual(const SolverOptions& solver, const std::vector<double>& residuals);

/// Describes a failed solve. `error`: of the solver's library, where it gave up; "": it did not. force_norm: what its
/// residual is relative to.
std::string describe_linear_solve(const Scene& scene, const LinearSolveResult& solve, const std::string& error,
                                  double force_norm);

/// Describes pairs that slide all over, and how much more than friction can carry the loads need; "" if none does.
/// sliding: of each pair, Friction::sliding().
std::string describe_sliding(const OuterProblem& problem, const FloatingBodies& floating,
                             const std::vector<double>& sliding);

}  // namespace cgcontact
