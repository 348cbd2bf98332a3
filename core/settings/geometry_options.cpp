#include "core/settings/geometry_options.hpp"

namespace cgcontact {

std::vector<Setting> GeometryOptions::settings() {
  return {method_constant("boundary_order", boundary_order,
                          "order of the rule of the boundary points: exact to degree 2 order - 1 on planes",
                          Range::integers(1, 8)),
          method_constant("prune_fraction", prune_fraction,
                          "cells with less of their volume are joined with a neighbour (docs/decisions.md, Geometry)",
                          Range::from_to(0, 1e-3, "0 to 1e-3")),
          method_constant("full_tolerance", full_tolerance,
                          "moments this near to those of a full cell, of its volume, are made full",
                          Range::from_to(0, 1e-3, "0 to 1e-3"))};
}

void GeometryOptions::check() const {
  GeometryOptions copy = *this;
  check_settings("geometry", copy.settings());
}

std::string GeometryOptions::print() const {
  GeometryOptions copy = *this, defaults;
  return print_settings("geometry", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
