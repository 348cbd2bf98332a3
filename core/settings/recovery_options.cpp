#include "core/settings/recovery_options.hpp"

#include <fmt/format.h>

#include "core/base/errors.hpp"

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
      {"spr_c", &spr_c},
      {"rank_tolerance", &rank_tolerance, Range::fraction()},
      {"auxiliary_depth", &auxiliary_depth, positive_up_to(4, "> 0 and <= 4 cells of the other body")},
      {"contact_edge", &contact_edge},
      {"pressure", choice_of(pressure, {"stress", "face"})},
      {"degree.interior", &degree.interior, Range::integers(1, 2)},
      {"degree.boundary", &degree.boundary, Range::integers(1, 2)},
      {"degree.contact", &degree.contact, Range::integers(0, 2)},
      {"rings", &quadratic_rings, Range::integers(0, 4)},
      {"points_per_face", &points_per_face, Range::from_to(0, 6, "0 (by the degree), 1, 3 or 6"), {0, 1, 3, 6}},
      {"patch_volume", &patch_volume, positive_up_to(8, "> 0 and <= 8 cells")},
      {"inverse_variance", &inverse_variance},
      method_constant("weak_rank_part", weak_rank_fraction, Range::fraction()),
      method_constant("closed_fraction", closed_fraction, Range::fraction()),
      method_constant("thick", thick, Range::integers(1, 16)),
      method_constant("least_auxiliary_volume", min_auxiliary_volume, positive_up_to(8, "> 0 and <= 8 cells")),
      method_constant("most_weight", max_weight, Range::from_to(1, 1e12, "1 to 1e12")),
      method_constant("conflict", conflict, Range::positive()),
      method_constant("firm_tolerance", firm_tolerance, Range::fraction()),
      method_constant("term_reach", term_reach, Range::not_negative("cells")),
      method_constant("balance.node_scatter", balance.node_scatter, Range::not_negative()),
      method_constant("balance.mean_width", balance.mean_width, Range::positive("cells")),
      method_constant("balance.mean_exact", balance.mean_exact, Range::fraction()),
      method_constant("balance.mean_wrong", balance.mean_wrong, Range::fraction()),
      method_constant("balance.total_exact", balance.total_exact, Range::not_negative())};
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
  RecoveryOptions copy = *this;
  return print_settings("recovery", copy.settings());
}

}  // namespace cgcontact
