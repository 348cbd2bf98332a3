#include "core/settings/solver_options.hpp"

namespace cgcontact {

const std::vector<std::string>& preconditioner_names() {
  static const std::vector<std::string> names{"multigrid", "muelu"};
  return names;
}

const std::string& name_of(Preconditioner preconditioner) {
  return preconditioner_names()[static_cast<std::size_t>(preconditioner)];
}

const std::vector<std::string>& linear_method_names() {
  static const std::vector<std::string> names{"flexible cg", "cg",          "block cg",       "minres",
                                              "gmres",       "block gmres", "flexible gmres", "bicgstab"};
  return names;
}

const std::string& name_of(LinearMethod method) { return linear_method_names()[static_cast<std::size_t>(method)]; }

std::vector<Setting> SolverOptions::settings() {
  return {
      {"method", choice_of(method, linear_method_names()), "Krylov method, by its name in Belos"},
      {"preconditioner", choice_of(preconditioner, preconditioner_names()),
       "of the linear system: geometric multigrid, or smoothed aggregation for comparison"},
      {"tolerance", &tolerance, "relative residual of the outer iteration", Range::tolerance()},
      {"max_outer_iterations", &max_outer_iterations,
       "up to four times as many while the residual falls by a fifth within five", Range::integers(1, 1000)},
      {"linear_tolerance", &linear_tolerance, "relative residual of the last linear solve", Range::tolerance()},
      {"max_linear_iterations", &max_linear_iterations, "of one linear solve", Range::integers(1, 1000000)},
      {"nested", &nested, "large grids start from solutions on coarser ones"},
      {"kappa", &kappa, "stabilisation of supports and contact, times E/h (docs/decisions.md, Supports and contact)",
       Range::from_to(1e-3, 1e6, "1e-3 to 1e6")},
      {"ghost_penalty", &ghost_penalty, "stabilisation of small cut cells", Range::from_to(0, 1e3, "0 to 1000")},
      {"shared_unknowns", &shared_unknowns, "several ranks divide grids of more unknowns (docs/parallel.md)",
       Range::integers(0, 2000000000)},
      method_constant("thin_kappa_factor", thin_kappa_factor,
                      "kappa at supports of thin bodies is that many times as large", Range::positive()),
      method_constant("inner_fraction", inner_fraction, "tolerance of a linear solve, of the outer residual before it",
                      Range::fraction()),
      method_constant("loosest_inner_tolerance", loosest_inner_tolerance, "largest tolerance of a linear solve",
                      Range::tolerance()),
      method_constant("largest_spring_part", largest_spring_fraction,
                      "fraction of the contact forces that springs which follow a motion may still take in the end",
                      Range::fraction()),
      method_constant("soft_hold", soft_hold,
                      "stiffness of what holds bodies while contact does not, of a support's on the softest body",
                      Range::fraction()),
      method_constant("small_zone_joins", small_zone_joins,
                      "fraction of the approach that cells may stand for below which groups join a small zone",
                      Range::fraction()),
      method_constant("small_zone_leaves", small_zone_leaves, "the same above which they leave it (docs/theory.md)",
                      Range::fraction()),
      method_constant("last_small_zone_decision", last_small_zone_decision,
                      "outer iterations in which groups may join or leave zones smaller than the cells",
                      Range::integers(0, 1000))};
}

void SolverOptions::check() const {
  SolverOptions copy = *this;
  check_settings("solver", copy.settings());
}

std::string SolverOptions::print() const {
  SolverOptions copy = *this, defaults;
  return print_settings("solver", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
