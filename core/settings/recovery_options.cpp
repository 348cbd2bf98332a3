#include "core/settings/recovery_options.hpp"

namespace cgcontact {

namespace {

Range positive_up_to(double max, const std::string& text) {
  Range range = Range::from_to(0, max, text);
  range.min_allowed = false;
  return range;
}

}  // namespace

std::vector<Setting> RecoveryOptions::settings() {
  return {{"spr_c", &spr_c},
          {"rank_tolerance", &rank_tolerance, Range::fraction()},
          {"auxiliary_depth", &auxiliary_depth, positive_up_to(4, "> 0 and <= 4 cells of the other body")},
          {"contact_edge", &contact_edge},
          {"degree.interior", &degree.interior, Range::integers(1, 2)},
          {"degree.boundary", &degree.boundary, Range::integers(1, 2)},
          {"degree.contact", &degree.contact, Range::integers(0, 2)},
          {"rings", &quadratic_rings, Range::integers(0, 4)},
          {"points_per_face", &points_per_face, Range::from_to(0, 6, "0 (by the degree), 1, 3 or 6"), {0, 1, 3, 6}},
          {"patch_volume", &patch_volume, positive_up_to(8, "> 0 and <= 8 cells")},
          {"inverse_variance", &inverse_variance},
          method_constant("quadratic_rank_part", quadratic_rank_part, Range::fraction())};
}

void RecoveryOptions::check() const {
  RecoveryOptions copy = *this;
  check_settings("recovery", copy.settings());
}

std::string RecoveryOptions::print() const {
  RecoveryOptions copy = *this;
  return print_settings("recovery", copy.settings());
}

}  // namespace cgcontact
