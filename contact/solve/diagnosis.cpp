#include "contact/solve/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/solve/active_set.hpp"

namespace cgcontact {
namespace {

/// Ratio of Young's moduli that may explain why the linear solver gives up.
constexpr double large_ratio = 1e7;
/// Iterations over which the pace of the residual is taken; the default of kappa is 10.
constexpr std::size_t pace = 4;
constexpr double small_kappa = 1;

const char* const all_open = "all contact has opened and nothing else holds the bodies";

std::string describe_open(const std::vector<std::string>& contacts) {
  return fmt::format("contact {} has opened wholly, and nothing else holds the body", fmt::join(contacts, ", "));
}

/// "; E of ... is 1e8 times that of ...", or nothing.
std::string describe_moduli(const std::vector<BodySpec>& bodies) {
  std::vector<const BodySpec*> elastic;
  for (const BodySpec& body : bodies)
    if (!body.rigid()) elastic.push_back(&body);
  const auto softer = [](const BodySpec* a, const BodySpec* b) {
    return a->material.youngs_modulus < b->material.youngs_modulus;
  };
  const auto [softest, stiffest] = std::minmax_element(elastic.begin(), elastic.end(), softer);
  const BodySpec *soft = *softest, *stiff = *stiffest;
  const double ratio = stiff->material.youngs_modulus / soft->material.youngs_modulus;
  if (!(ratio > large_ratio)) return "";
  return fmt::format("; E of \"{}\" is {:.1g} times that of \"{}\": is a unit wrong?", stiff->name, ratio, soft->name);
}

}  // namespace

std::string describe_loss_of_contact(const std::vector<ContactPair>& pairs) {
  if (count_active(pairs) == 0) return all_open;
  std::vector<std::string> opened;
  for (const ContactPair& pair : pairs)
    if (std::none_of(pair.points.begin(), pair.points.end(), [](const ContactPoint& q) { return q.active; }))
      opened.push_back('"' + pair.spec->name + '"');
  return opened.empty() ? "the contact that is left closed does not hold the bodies" : describe_open(opened);
}

std::string describe_separation(const std::vector<std::string>& opened, std::size_t num_pairs) {
  if (opened.empty()) return "the loads push a body out of its contact";
  return opened.size() == num_pairs ? all_open : describe_open(opened);
}

std::string describe_residual(const SolverOptions& solver, const std::vector<double>& residuals) {
  std::string text = fmt::format(
      "outer residual {:.2e} after {} iterations (solver.tolerance = {:g}, solver.max_outer_iterations = {}{})",
      residuals.back(), residuals.size(), solver.tolerance, solver.max_outer_iterations,
      residuals.size() > static_cast<std::size_t>(solver.max_outer_iterations) ? ", more while it falls" : "");
  if (residuals.size() > pace) {
    const double factor = std::pow(residuals.back() / residuals[residuals.size() - 1 - pace], 1.0 / pace);
    text += factor < 1 ? fmt::format("; it fell by a factor {:.2g} per iteration", factor) : "; it does not fall";
  }
  if (solver.kappa < small_kappa)
    text += fmt::format("; solver.kappa = {:g} is small: this iteration converges the faster the larger it is",
                        solver.kappa);
  return text;
}

std::string describe_linear_solve(const Scene& scene, const LinearSolveResult& solve, const std::string& error,
                                  double force_norm) {
  if (!error.empty()) return "the linear solver failed: " + error;
  if (!std::isfinite(solve.residual))
    return "numbers overflow: a load, a prescribed displacement or a modulus is out of all proportion";
  return fmt::format(
             "the linear solver stopped after {} iterations at a relative residual of {:.2e} "
             "(solver.max_linear_iterations, solver.linear_tolerance)",
             solve.iterations, solve.residual / force_norm) +
         describe_moduli(scene.bodies);
}

std::string describe_sliding(const OuterProblem& problem, const FloatingBodies& floating,
                             const std::vector<double>& sliding) {
  std::string text;
  for (std::size_t k = 0; k < sliding.size(); ++k) {
    const ContactPair& pair = problem.pairs[k];
    if (sliding[k] == 0 || !floating.may_slide(pair)) continue;
    const bool alone = std::none_of(problem.pairs.begin(), problem.pairs.end(), [&](const ContactPair& other) {
      return &other != &pair && other.friction() > 0 &&
             (other.primary == pair.primary || other.secondary == pair.primary || other.primary == pair.secondary ||
              other.secondary == pair.secondary);
    });
    text += fmt::format(
        "{}contact \"{}\": \"{}\" slides on \"{}\" all over: the loads need {:.4g} times what friction can carry "
        "there{} "
        "(friction = {:g})",
        text.empty() ? "" : "; ", pair.spec->name, problem.scene.bodies[pair.spec->first.body].name,
        problem.scene.bodies[pair.spec->second.body].name, 1 + sliding[k],
        alone ? "" : ", beside what other contacts of these bodies carry", pair.friction());
  }
  return text;
}

}  // namespace cgcontact
