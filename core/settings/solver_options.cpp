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
  return {{"method", choice_of(method, linear_method_names())},
          {"preconditioner", choice_of(preconditioner, preconditioner_names())},
          {"tolerance", &tolerance, Range::tolerance()},
          {"max_outer_iterations", &max_outer_iterations, Range::integers(1, 1000)},
          {"linear_tolerance", &linear_tolerance, Range::tolerance()},
          {"max_linear_iterations", &max_linear_iterations, Range::integers(1, 1000000)},
          {"nested", &nested},
          {"kappa", &kappa, Range::from_to(1e-3, 1e6, "1e-3 to 1e6")},
          {"ghost_penalty", &ghost_penalty, Range::from_to(0, 1e3, "0 to 1000")},
          {"shared_unknowns", &shared_unknowns, Range::integers(0, 2000000000)},
          method_constant("thin_kappa_factor", thin_kappa_factor, Range::positive()),
          method_constant("inner_fraction", inner_fraction, Range::fraction()),
          method_constant("loosest_inner_tolerance", loosest_inner_tolerance, Range::tolerance()),
          method_constant("largest_spring_part", largest_spring_fraction, Range::fraction()),
          method_constant("soft_hold", soft_hold, Range::fraction()),
          method_constant("small_zone_joins", small_zone_joins, Range::fraction()),
          method_constant("small_zone_leaves", small_zone_leaves, Range::fraction()),
          method_constant("last_small_zone_decision", last_small_zone_decision, Range::integers(0, 1000))};
}

void SolverOptions::check() const {
  SolverOptions copy = *this;
  check_settings("solver", copy.settings());
}

std::string SolverOptions::print() const {
  SolverOptions copy = *this;
  return print_settings("solver", copy.settings());
}

}  // namespace cgcontact
