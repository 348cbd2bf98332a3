#include "core/settings/result_options.hpp"

namespace cgcontact {

std::vector<Setting> ResultOptions::settings() {
  return {method_constant("least_cells_across", min_cells_across, Range::positive("cells")),
          method_constant("wanted_cells_across", wanted_cells_across, Range::positive("cells")),
          method_constant("least_cells_on_face", min_cells_on_face, Range::positive("cells")),
          method_constant("least_thickness", min_thickness, Range::positive("cells")),
          method_constant("wanted_thickness", wanted_thickness, Range::positive("cells")),
          method_constant("lost_force", lost_force, Range::fraction()),
          method_constant("lost_load", lost_load, Range::fraction()),
          method_constant("largest_imbalance", largest_imbalance, Range::fraction()),
          method_constant("largest_hold", largest_hold, Range::fraction()),
          method_constant("largest_error", largest_error, Range::fraction()),
          method_constant("largest_strain", largest_strain, Range::fraction()),
          method_constant("largest_displacement", largest_displacement, Range::fraction()),
          method_constant("largest_pressure", largest_pressure, Range::fraction()),
          method_constant("mean_width", mean_width, Range::positive("cells")),
          method_constant("spoilt_at_edge", spoilt_at_edge, Range::not_negative("cells")),
          method_constant("edge_factor", edge_factor, Range::not_negative()),
          method_constant("largest_jump", largest_jump, Range::fraction())};
}

void ResultOptions::check() const {
  ResultOptions copy = *this;
  check_settings("results", copy.settings());
}

std::string ResultOptions::print() const {
  ResultOptions copy = *this;
  return print_settings("results", copy.settings());
}

}  // namespace cgcontact
