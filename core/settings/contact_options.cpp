#include "core/settings/contact_options.hpp"

namespace cgcontact {

std::vector<Setting> ContactOptions::settings() {
  return {
      method_constant("quadrature_order", quadrature_order,
                      "order of the rule of the contact points: exact for what the patch test needs",
                      Range::integers(1, 8)),
      method_constant("bond_reach", bond_reach, "gap of bonded faces up to which they are tied, in the larger cells",
                      Range::positive("cells")),
      method_constant("bond_gap", bond_gap, "gap of bonded faces from which on there is a warning, in the larger cells",
                      Range::positive("cells")),
      method_constant("reach_in_cells", reach_in_cells,
                      "a pair sees its closest points and that much beyond them, in the larger cells",
                      Range::positive("cells")),
      method_constant("reach_in_extents", reach_in_extents,
                      "the same, of the smaller body's longest extent; the larger of both counts", Range::fraction()),
      method_constant("largest_overlap", largest_overlap,
                      "largest overlap, of the smaller body's longest extent: small strain is off by as much",
                      Range::fraction())};
}

void ContactOptions::check() const {
  ContactOptions copy = *this;
  check_settings("contact", copy.settings());
}

std::string ContactOptions::print() const {
  ContactOptions copy = *this, defaults;
  return print_settings("contact", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
