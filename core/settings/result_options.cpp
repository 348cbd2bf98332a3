#include "core/settings/result_options.hpp"

namespace cgcontact {

std::vector<Setting> ResultOptions::settings() {
  return {
      method_constant("least_cells_across", min_cells_across,
                      "cells across a zone below which its pressure, if of the stress, is unreliable",
                      Range::positive("cells")),
      method_constant("wanted_cells_across", wanted_cells_across,
                      "cells across a zone that are recommended (docs/recovery.md, Error figures)",
                      Range::positive("cells")),
      method_constant("least_cells_on_face", min_cells_on_face,
                      "least cells across where the pressure is that of the face (docs/accuracy.md)",
                      Range::positive("cells")),
      method_constant("least_thickness", min_thickness,
                      "cells over the thickness of a body below which its bending is not resolved",
                      Range::positive("cells")),
      method_constant("wanted_thickness", wanted_thickness,
                      "cells over the thickness that are recommended (docs/decisions.md)", Range::positive("cells")),
      method_constant("lost_force", lost_force,
                      "fraction of the transmitted force that the recovered pressure may miss without a warning",
                      Range::fraction()),
      method_constant("lost_load", lost_load,
                      "fraction of a load that the quadrature of its expression may miss without a warning",
                      Range::fraction()),
      method_constant("largest_imbalance", largest_imbalance,
                      "fraction of a contact's force by which the forces on its bodies may not balance",
                      Range::fraction()),
      method_constant("largest_hold", largest_hold,
                      "fraction of a contact's force that what holds otherwise unresisted motions may take",
                      Range::fraction()),
      method_constant("largest_error", largest_error,
                      "fraction of the integral of a contact's pressure that its estimated errors may add up to",
                      Range::fraction()),
      method_constant("largest_strain", largest_strain,
                      "strain above which there is a warning: second order is some 5 % of it", Range::fraction()),
      method_constant("largest_displacement", largest_displacement,
                      "displacement above which there is a warning, of the body's longest side", Range::fraction()),
      method_constant("largest_pressure", largest_pressure, "contact pressure above which there is a warning, of E",
                      Range::fraction()),
      method_constant("mean_width", mean_width,
                      "width of the Gaussian of the local mean in the pressure's estimated error",
                      Range::positive("cells")),
      method_constant("spoilt_at_edge", spoilt_at_edge,
                      "distance from the border of closed points within which the transmitted pressure is spoilt",
                      Range::not_negative("cells")),
      method_constant("largest_jump", largest_jump,
                      "fraction of the largest pressure by which the pressure may leave that of its surroundings",
                      Range::fraction())};
}

void ResultOptions::check() const {
  ResultOptions copy = *this;
  check_settings("results", copy.settings());
}

std::string ResultOptions::print() const {
  ResultOptions copy = *this, defaults;
  return print_settings("results", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
