#include "core/settings/recovery_options.hpp"

#include <fmt/format.h>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

Range positive_up_to(double max, const std::string& text) {
  Range range = Range::from_to(0, max, text);
  range.min_allowed = false;
  return range;
}

}  // namespace

std::vector<Setting> RecoveryOptions::settings() {
  std::vector<Setting> all{
      {"spr_c", &spr_c, "recovery with constraints (SPR-C) beside the plain one (SPR)"},
      {"rank_tolerance", &rank_tolerance, "constraints weaker than this, of the strongest of a patch, are redundant",
       Range::fraction()},
      {"auxiliary_depth", &auxiliary_depth, "depth of the auxiliary patch in the other body",
       positive_up_to(4, "> 0 and <= 4 cells of the other body")},
      {"contact_edge", &contact_edge, "a term for the square root at the edge of contact zones"},
      {"pressure", choice_of(pressure, {"stress", "face"}),
       "source of the contact pressure: the recovered stress, or a problem on the face of each zone"},
      {"degree.interior", &degree.interior, "degree of the polynomials in patches of full cells without contact face",
       Range::integers(1, 2)},
      {"degree.boundary", &degree.boundary, "degree in patches that are neither interior nor at a contact",
       Range::integers(1, 2)},
      {"degree.contact", &degree.contact,
       "degree in patches with points of a contact face; 0: 2 where closed and both bodies are thick",
       Range::integers(0, 2)},
      {"rings", &quadratic_rings, "rings of cells around a node for polynomials of degree 2; 0: automatic",
       Range::integers(0, 4)},
      {"points_per_face",
       &points_per_face,
       "constraint points per face and patch",
       Range::from_to(0, 6, "0 (by the degree), 1, 3 or 6"),
       {0, 1, 3, 6}},
      {"patch_volume", &patch_volume, "patches of less volume are joined with a neighbour's",
       positive_up_to(8, "> 0 and <= 8 cells")},
      {"inverse_variance", &inverse_variance,
       "misfits in patches of two bodies count with the inverse of their variance"},
      method_constant("weak_rank_part", weak_rank_fraction,
                      "of rank_tolerance, for degree 2 and bodies of revolution (docs/recovery.md)", Range::fraction()),
      method_constant("closed_fraction", closed_fraction,
                      "fraction of its contact area from which on a patch counts as closed", Range::fraction()),
      method_constant("thick", thick,
                      "cells across both bodies from which on patches with closed contact are of degree 2",
                      Range::integers(1, 16)),
      method_constant("least_auxiliary_volume", min_auxiliary_volume,
                      "least volume of an auxiliary patch: less carries no linear polynomial",
                      positive_up_to(8, "> 0 and <= 8 cells")),
      method_constant("most_weight", max_weight,
                      "largest ratio of the weights of both bodies' misfits in a coupled patch",
                      Range::from_to(1, 1e12, "1 to 1e12")),
      method_constant("conflict", conflict,
                      "residual of normalised rows, of the stress level, above which the data contradict each other",
                      Range::positive()),
      method_constant("firm_tolerance", firm_tolerance,
                      "rank tolerance of the rows of open faces alone (docs/recovery.md, Truncation)",
                      Range::fraction()),
      method_constant("term_reach", term_reach,
                      "patches whose contact face begins closer to the edge of a zone carry the edge's term",
                      Range::not_negative("cells")),
      method_constant("balance.node_scatter", balance.node_scatter,
                      "scatter of the transmitted force of a node with half a cell's face, of the pressure around",
                      Range::not_negative()),
      method_constant("balance.mean_width", balance.mean_width,
                      "standard deviation of the local mean of the balance with the transmitted forces",
                      Range::positive("cells")),
      method_constant("balance.mean_exact", balance.mean_exact,
                      "relative error of that mean up to which nothing is changed", Range::fraction()),
      method_constant("balance.mean_wrong", balance.mean_wrong,
                      "relative error of that mean from which on all of it is changed", Range::fraction()),
      method_constant("balance.total_exact", balance.total_exact,
                      "of the force: by how much its total may be farther off than that of the plain recovery",
                      Range::not_negative())};
  const std::vector<Setting> of_face = face.settings();
  all.insert(all.end(), of_face.begin(), of_face.end());
  return all;
}

void RecoveryOptions::check() const {
  RecoveryOptions copy = *this;
  check_settings("recovery", copy.settings());
  const auto above = [](const std::string& key, double value, double least, const std::string& other) {
    if (!(value > least))
      throw InputError(SourceLocation{"", 0, "recovery." + key}, fmt::format("{}", value), "out of range",
                       "> recovery." + other);
  };
  above("balance.mean_wrong", balance.mean_wrong, balance.mean_exact, "balance.mean_exact");
}

std::string RecoveryOptions::print() const {
  RecoveryOptions copy = *this, defaults;
  return print_settings("recovery", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
