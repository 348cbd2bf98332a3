#include "core/settings/accuracy_options.hpp"

#include <fmt/format.h>

#include <sstream>

namespace cgcontact {

namespace {

/// Writes {"name" = target, ...}; "" of none.
std::string table_of_targets(const std::vector<std::pair<std::string, double>>& targets) {
  std::string text;
  for (const auto& [name, error] : targets) text += fmt::format("{}\"{}\" = {}", text.empty() ? "" : ", ", name, error);
  return text.empty() ? "" : "{" + text + "}";
}

/// Makes a comment of every line that is none: a scene with the section must ask for something.
std::string in_comments(const std::string& text) {
  std::string comments;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) comments += (line.front() == '#' ? "" : "# ") + line + "\n";
  return comments;
}

}  // namespace

std::string AccuracyOptions::stress_text() const {
  if (stress) return fmt::format("{}", *stress);
  std::vector<std::pair<std::string, double>> targets;
  for (const BodyTarget& target : stress_of_body) targets.emplace_back(target.body, target.error);
  return table_of_targets(targets);
}

std::string AccuracyOptions::displacement_text() const {
  std::vector<std::pair<std::string, double>> targets;
  for (const NamedTarget& target : named)
    if (target.kind == NamedTarget::Kind::displacement) targets.emplace_back(target.name, target.error);
  return table_of_targets(targets);
}

std::vector<Setting> AccuracyOptions::settings() {
  const auto target = [](const std::string& key, Target& value, const std::string& meaning) {
    return Setting{key, &value, "relative error of " + meaning, Range::fraction(), {}, "none"};
  };
  return {target("pressure", pressure, "the contact pressure, L2 norm over the faces of each pair"),
          target("force", force, "the contact force of each pair"),
          target("shear", shear, "friction's shear, L2 norm over the faces of each pair"),
          {"stress",
           OwnForm{[this] { return stress_text(); }},
           "relative error of the stress in the energy norm, of all bodies together or of bodies by name",
           Range::fraction(),
           {},
           "none"},
          {"displacement",
           OwnForm{[this] { return displacement_text(); }},
           "relative error of the largest displacement, or of means over faces or probes by name",
           Range::fraction(),
           {},
           "none"},
          {"max_unknowns", &max_unknowns, "of one solve", Range::from_to(1000, 2e9, "1000 to 2e9 unknowns")},
          {"max_time", &max_time, "of all solves and their grids together",
           Range::from_to(0.001, 1e9, "0.001 to 1e9 s", "s")},
          {"max_levels", &max_levels, "sizes of cells of one body, each half the previous", Range::integers(1, 20)},
          {"max_solves", &max_solves, "grids that are tried", Range::integers(1, 100)},
          method_constant("first_cells_through", first_cells_through,
                          "first grid without cell_size: cells over the mean thickness of a body",
                          Range::positive("cells")),
          method_constant("most_first_cells", max_first_cells,
                          "first grid without cell_size: largest number of cells in a body", Range::positive("cells")),
          method_constant("grading", grading, "growth of the cells with the distance from the contact zone",
                          Range::from_to(0.05, 1, "0.05 to 1")),
          method_constant("beyond_zone", beyond_zone,
                          "fraction of half a zone's width by which its cells go on beyond its closed points",
                          Range::not_negative()),
          method_constant("middle_cells", middle_cells,
                          "cells over half the width of a zone on the first grid that resolves it",
                          Range::positive("cells")),
          method_constant("narrowing", narrowing, "refinement where nothing but the group of a zone is known",
                          Range::from_to(2, 1000, "2 to 1000")),
          method_constant("aim", aim, "fraction of the target that the next grid aims at", Range::fraction()),
          method_constant("rate", rate, "power of the size that errors are taken to fall with", Range::positive()),
          method_constant("safety", safety,
                          "factor on the estimate of one solution: true errors are below the product in 95 % of runs",
                          Range::positive()),
          method_constant("doubtful_width", doubtful_width,
                          "cells across a zone at which that estimate is half of what it should be",
                          Range::not_negative("cells")),
          method_constant("energy_aim", energy_aim,
                          "fraction of what the targets allow that the next grid aims at for the energy norm",
                          Range::fraction()),
          method_constant("least_change", min_change, "least factor between sizes of one solve and the next",
                          Range::from_to(1, 100, "1 to 100")),
          method_constant("most_change", max_change, "largest factor between sizes of one solve and the next",
                          Range::from_to(1, 100, "1 to 100")),
          method_constant("force_part", force_fraction,
                          "fraction of the target of the pressure that the force's error may take", Range::fraction()),
          method_constant("energy_grading", energy_grading,
                          "growth of cells with the distance from those that the energy norm's error asks for",
                          Range::from_to(0.05, 1, "0.05 to 1")),
          method_constant("near_gap", near_gap,
                          "faces of an open pair this near may touch between the points where the gap is known",
                          Range::fraction())};
}

int AccuracyOptions::named_pressure(const std::string& pair) const {
  for (std::size_t k = 0; k < named.size(); ++k)
    if (named[k].kind == NamedTarget::Kind::pressure && named[k].name == pair) return static_cast<int>(k);
  return -1;
}

Target AccuracyOptions::pressure_of(const std::string& pair) const {
  const int own = named_pressure(pair);
  return own < 0 ? pressure : named[own].error;
}

void AccuracyOptions::check() const {
  AccuracyOptions copy = *this;
  check_settings("accuracy", copy.settings());
}

std::string AccuracyOptions::print() const {
  AccuracyOptions copy = *this, defaults;
  const std::string text = print_settings("accuracy", copy.settings(), defaults.settings());
  return any() ? text : in_comments(text);
}

}  // namespace cgcontact
