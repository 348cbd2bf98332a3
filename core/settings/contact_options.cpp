#include "core/settings/contact_options.hpp"

namespace cgcontact {

std::vector<Setting> ContactOptions::settings() {
  return {method_constant("quadrature_order", quadrature_order, Range::integers(1, 8)),
          method_constant("bond_reach", bond_reach, Range::positive("cells")),
          method_constant("bond_gap", bond_gap, Range::positive("cells")),
          method_constant("reach_in_cells", reach_in_cells, Range::positive("cells")),
          method_constant("reach_in_extents", reach_in_extents, Range::fraction()),
          method_constant("largest_overlap", largest_overlap, Range::fraction())};
}

void ContactOptions::check() const {
  ContactOptions copy = *this;
  check_settings("contact", copy.settings());
}

std::string ContactOptions::print() const {
  ContactOptions copy = *this;
  return print_settings("contact", copy.settings());
}

}  // namespace cgcontact
