#include "core/settings/geometry_options.hpp"

namespace cgcontact {

std::vector<Setting> GeometryOptions::settings() {
  return {method_constant("boundary_order", boundary_order, Range::integers(1, 8)),
          method_constant("prune_fraction", prune_fraction, Range::from_to(0, 1e-3, "0 to 1e-3")),
          method_constant("full_tolerance", full_tolerance, Range::from_to(0, 1e-3, "0 to 1e-3"))};
}

void GeometryOptions::check() const {
  GeometryOptions copy = *this;
  check_settings("geometry", copy.settings());
}

std::string GeometryOptions::print() const {
  GeometryOptions copy = *this;
  return print_settings("geometry", copy.settings());
}

}  // namespace cgcontact
