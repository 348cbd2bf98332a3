#include "contact/results/reference/pressure_error.hpp"

#include <cmath>

namespace cgcontact {

std::vector<ZoneError> pressure_errors(const std::vector<ContactRow>& rows,
                                       const std::function<double(const ContactRow&)>& reference,
                                       const std::vector<std::pair<std::string, Expression>>& zones) {
  std::vector<ZoneError> errors{{"whole", 0, 0, 0}};
  for (const auto& zone : zones) errors.push_back({zone.first, 0, 0, 0});
  std::vector<char> seen(errors.size(), 0);
  double norm = 0;
  for (const ContactRow& r : rows) {
    const double p = reference(r);
    norm += r.weight * p * p;
    const auto add = [&](std::size_t k) {
      seen[k] = 1;
      errors[k].raw += r.weight * std::pow(r.pressure_raw - p, 2);
      errors[k].spr += r.weight * std::pow(r.pressure_spr - p, 2);
      errors[k].sprc += r.weight * std::pow(r.pressure_sprc - p, 2);
    };
    add(0);
    for (std::size_t z = 0; z < zones.size(); ++z)
      if (zones[z].second(r.x) != 0) add(1 + z);
  }
  if (!(norm > 0)) return {};
  std::vector<ZoneError> known;
  for (std::size_t k = 0; k < errors.size(); ++k)
    if (seen[k])
      known.push_back({errors[k].zone, std::sqrt(errors[k].raw / norm), std::sqrt(errors[k].spr / norm),
                       std::sqrt(errors[k].sprc / norm)});
  return known;
}

}  // namespace cgcontact
