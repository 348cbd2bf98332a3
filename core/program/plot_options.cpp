#include "core/program/plot_options.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cstdlib>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/expressions/expression.hpp"

namespace cgcontact {

namespace {

const char* const allowed_planes = "x, y or z = a length with its unit, such as z=5mm";
const char* const allowed_ends = "LOW:HIGH with a unit, such as \"0:300 MPa\"; LOW < HIGH";

[[noreturn]] void refuse_plot_option(const std::string& value, const std::string& problem, const std::string& allowed) {
  throw InputError(fmt::format("\"{}\" {} (allowed: {})", value, problem, allowed));
}

/// Returns the unit that a text ends with, or "": "300 MPa" has "MPa".
std::string unit_behind(const std::string& text) {
  for (std::size_t k = 1; k < text.size(); ++k)
    if (std::isalpha(static_cast<unsigned char>(text[k])) && length_of_unit(text, k) == text.size() - k)
      return text.substr(k);
  return "";
}

}  // namespace

PlotOptions::Plane parse_plane(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string axis = trimmed(text.substr(0, equals));
  if (equals == std::string::npos || axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z')
    refuse_plot_option(text, "is no plane", allowed_planes);
  const std::string value = trimmed(text.substr(equals + 1));
  const Quantity quantity = evaluate_constant(value, {});
  if (!quantity.has_units && quantity.value != 0) refuse_plot_option(text, "has no unit", allowed_planes);
  return {axis[0] - 'x', value_in(unit_named("m"), quantity, {}, "\"" + text + "\"", allowed_planes), text};
}

PlotOptions::Ends parse_ends(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos)
    refuse_plot_option(text, "is no range", allowed_ends);
  std::array<std::string, 2> parts{trimmed(text.substr(0, colon)), trimmed(text.substr(colon + 1))};
  PlotOptions::Ends ends;
  ends.text = text;
  const std::array<std::string, 2> units{unit_behind(parts[0]), unit_behind(parts[1])};
  for (int k = 0; k < 2; ++k) {
    if (parts[k].empty()) refuse_plot_option(text, "has one end only", allowed_ends);
    if (units[k].empty() && !units[1 - k].empty()) parts[k] = "(" + parts[k] + ") * 1 " + units[1 - k];
    ends.values[k] = evaluate_constant(parts[k], {});
  }
  if (!(ends.values[0].value < ends.values[1].value))
    refuse_plot_option(text, "ends below where it begins, or there", allowed_ends);
  return ends;
}

std::string parse_zoom(const std::string& text) {
  const std::string word = "contact", allowed = "contact, or contact:PAIR with the name of a pair";
  if (text == word) return "";
  if (text.rfind(word + ":", 0) != 0 || text.size() == word.size() + 1)
    refuse_plot_option(text, "is nothing to look at", allowed);
  return text.substr(word.size() + 1);
}

int parse_plot_step(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1)
    refuse_plot_option(text, "is no step", "an integer from 1 on");
  return value;
}

double parse_deformed(const std::string& text) {
  const std::string allowed = "a number from 0 to 1e9: displacements are multiplied by it";
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool decimal = text.find_first_not_of("+-.0123456789eE") == std::string::npos;
  if (text.empty() || *end != '\0' || !decimal) refuse_plot_option(text, "is not a number", allowed);
  if (!(value >= 0) || value > 1e9) refuse_plot_option(text, "is out of range", allowed);
  return value;
}

}  // namespace cgcontact
