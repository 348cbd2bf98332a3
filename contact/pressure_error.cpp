#include "contact/pressure_error.hpp"

#include <cmath>

namespace cgcontact {

std::vector<ZoneError> pressure_errors(const std::vector<ContactRow>& rows,
                                       const std::function<double(const ContactRow&)>& reference,
                                       const std::vector<std::pair<std::string, Expression>>& zones) {
  std::vector<ZoneError> errors{{"whole", 0, 0, 0}};
  for (const auto& zone : zones) errors.push_back({zone.first, 0, 0, 0});
  double norm = 0;
  for (const ContactRow& r : rows) {
    const double p = reference(r);
    norm += r.weight * p * p;
    const auto add = [&](ZoneError& zone) {
      zone.raw += r.weight * std::pow(r.pressure_raw - p, 2);
      zone.spr += r.weight * std::pow(r.pressure_spr - p, 2);
      zone.sprc += r.weight * std::pow(r.pressure_sprc - p, 2);
    };
    add(errors[0]);
    for (std::size_t z = 0; z < zones.size(); ++z)
      if (zones[z].second(r.x) != 0) add(errors[1 + z]);
  }
  for (ZoneError& zone : errors) {
    zone.raw = std::sqrt(zone.raw / norm);
    zone.spr = std::sqrt(zone.spr / norm);
    zone.sprc = std::sqrt(zone.sprc / norm);
  }
  return errors;
}

}  // namespace cgcontact
