#include "core/settings/accuracy_options.hpp"

namespace cgcontact {

std::vector<Setting> AccuracyOptions::settings() {
  return {{"max_unknowns", &max_unknowns, Range::from_to(1000, 2e9, "1000 to 2e9 unknowns")},
          {"max_time", &max_time, Range::from_to(0.001, 1e9, "0.001 to 1e9 s", "s")},
          {"max_levels", &max_levels, Range::integers(1, 20)},
          {"max_solves", &max_solves, Range::integers(1, 100)},
          method_constant("first_cells_through", first_cells_through, Range::positive("cells")),
          method_constant("most_first_cells", max_first_cells, Range::positive("cells")),
          method_constant("grading", grading, Range::from_to(0.05, 1, "0.05 to 1")),
          method_constant("beyond_zone", beyond_zone, Range::not_negative()),
          method_constant("middle_cells", middle_cells, Range::positive("cells")),
          method_constant("narrowing", narrowing, Range::from_to(2, 1000, "2 to 1000")),
          method_constant("aim", aim, Range::fraction()),
          method_constant("rate", rate, Range::positive()),
          method_constant("safety", safety, Range::positive()),
          method_constant("doubtful_width", doubtful_width, Range::not_negative("cells")),
          method_constant("energy_aim", energy_aim, Range::fraction()),
          method_constant("least_change", min_change, Range::from_to(1, 100, "1 to 100")),
          method_constant("most_change", max_change, Range::from_to(1, 100, "1 to 100")),
          method_constant("force_part", force_fraction, Range::fraction()),
          method_constant("energy_grading", energy_grading, Range::from_to(0.05, 1, "0.05 to 1")),
          method_constant("near_gap", near_gap, Range::fraction())};
}

int AccuracyOptions::named_pressure(const std::string& pair) const {
  for (std::size_t k = 0; k < named.size(); ++k)
    if (named[k].kind == NamedTarget::Kind::pressure && named[k].name == pair) return static_cast<int>(k);
  return -1;
}

std::optional<double> AccuracyOptions::pressure_of(const std::string& pair) const {
  const int own = named_pressure(pair);
  return own < 0 ? pressure : named[own].error;
}

void AccuracyOptions::check() const {
  AccuracyOptions copy = *this;
  check_settings("accuracy", copy.settings());
}

std::string AccuracyOptions::print() const {
  AccuracyOptions copy = *this;
  return print_settings("accuracy", copy.settings());
}

}  // namespace cgcontact
