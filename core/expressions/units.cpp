#include "core/expressions/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

namespace {

constexpr double pound = 0.45359237;             // kg, by definition
constexpr double pound_force = 4.4482216152605;  // N, by definition: pound times 9.80665 m/s^2
constexpr double square_inch = 6.4516e-4;        // m^2
constexpr int max_exponent = 9;                  // one digit

constexpr Dimension pure{{0, 0, 0, 0, 0}}, length{{1, 0, 0, 0, 0}}, mass{{0, 1, 0, 0, 0}}, duration{{0, 0, 1, 0, 0}},
    temperature{{0, 0, 0, 1, 0}}, angle{{0, 0, 0, 0, 1}}, force{{1, 1, -2, 0, 0}}, pressure{{-1, 1, -2, 0, 0}},
    moment{{2, 1, -2, 0, 0}}, rotation{{0, 0, -1, 0, 1}};

struct NamedUnit {
  const char* name;
  Unit unit;
};

/// Symbols of the SI and of inches and pounds.
const std::vector<NamedUnit>& all_units() {
  static const std::vector<NamedUnit> units{
      {"m", {1, 1, length}},
      {"km", {1000, 1, length}},
      {"dm", {1, 10, length}},
      {"cm", {1, 100, length}},
      {"mm", {1, 1000, length}},
      {"um", {1, 1e6, length}},
      {"\u00b5m", {1, 1e6, length}},
      {"\u03bcm", {1, 1e6, length}},
      {"nm", {1, 1e9, length}},
      {"in", {254, 10000, length}},
      {"ft", {3048, 10000, length}},
      {"kg", {1, 1, mass}},
      {"g", {1, 1000, mass}},
      {"mg", {1, 1e6, mass}},
      {"t", {1000, 1, mass}},
      {"lb", {pound, 1, mass}},
      {"s", {1, 1, duration}},
      {"ms", {1, 1000, duration}},
      {"min", {60, 1, duration}},
      {"h", {3600, 1, duration}},
      {"K", {1, 1, temperature}},
      {"rad", {1, 1, angle}},
      {"mrad", {1, 1000, angle}},
      {"deg", {pi, 180, angle}},
      {"degrees", {pi, 180, angle}},
      {"\u00b0", {pi, 180, angle}},
      {"N", {1, 1, force}},
      {"mN", {1, 1000, force}},
      {"kN", {1000, 1, force}},
      {"MN", {1e6, 1, force}},
      {"lbf", {pound_force, 1, force}},
      {"Pa", {1, 1, pressure}},
      {"kPa", {1000, 1, pressure}},
      {"MPa", {1e6, 1, pressure}},
      {"GPa", {1e9, 1, pressure}},
      {"mbar", {100, 1, pressure}},
      {"bar", {1e5, 1, pressure}},
      {"psi", {pound_force, square_inch, pressure}},
      {"ksi", {1000 * pound_force, square_inch, pressure}},
      {"Nm", {1, 1, moment}},
      {"Nmm", {1, 1000, moment}},
      {"kNm", {1000, 1, moment}},
      {"rpm", {pi, 30, rotation}},
  };
  return units;
}

struct NamedDimension {
  Dimension dimension;
  const char* name;
  const char* units;
};

const std::vector<NamedDimension>& named_dimensions() {
  static const std::vector<NamedDimension> all{
      {pure, "a pure number", ""},
      {length, "a length", "um, mm, cm, m, in, ft"},
      {{{2, 0, 0, 0, 0}}, "an area", "mm^2, cm^2, m^2, in^2"},
      {{{3, 0, 0, 0, 0}}, "a volume", "mm^3, cm^3, m^3, in^3"},
      {{{-1, 0, 0, 0, 0}}, "one over a length", "1/mm, 1/m"},
      {angle, "an angle", "deg, rad, mrad"},
      {mass, "a mass", "g, kg, t, lb"},
      {duration, "a time", "ms, s, min, h"},
      {temperature, "a temperature difference", "K"},
      {{{0, 0, 0, -1, 0}}, "a coefficient of expansion", "1/K"},
      {force, "a force", "mN, N, kN, MN, lbf"},
      {moment, "a moment", "Nmm, Nm, kNm, N*m"},
      {pressure, "a pressure", "Pa, kPa, MPa, GPa, N/mm^2, bar, psi, ksi"},
      {{{0, 1, -2, 0, 0}}, "a stiffness or force per length", "N/mm, N/m, kN/m"},
      {{{-2, 1, -2, 0, 0}}, "a force per volume", "N/mm^3, N/m^3, kN/m^3, MPa/mm"},
      {{{-3, 1, 0, 0, 0}}, "a density", "kg/m^3, g/cm^3, t/m^3"},
      {{{1, 0, -1, 0, 0}}, "a speed", "mm/s, m/s"},
      {{{1, 0, -2, 0, 0}}, "an acceleration", "m/s^2"},
      {rotation, "a speed of rotation", "rpm, rad/s, deg/s"},
      {{{0, 0, -1, 0, 0}}, "one over a time", "1/s, rpm"},
  };
  return all;
}

bool in_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80; }

bool starts_with(const std::string& text, std::size_t k, const char* beginning) {
  return text.compare(k, std::string(beginning).size(), beginning) == 0;
}

/// Length of the name at k, without the signs for powers and products.
std::size_t length_of_name(const std::string& text, std::size_t k) {
  const std::size_t begin = k;
  while (k < text.size() && in_name(text[k]) && !starts_with(text, k, "\u00b2") && !starts_with(text, k, "\u00b3") &&
         !starts_with(text, k, "\u00b7"))
    ++k;
  return k - begin;
}

const Unit* unit_of_name(const std::string& name) {
  for (const NamedUnit& entry : all_units())
    if (name == entry.name) return &entry.unit;
  return nullptr;
}

std::size_t skip_blanks(const std::string& text, std::size_t k) {
  while (k < text.size() && (text[k] == ' ' || text[k] == '\t')) ++k;
  return k;
}

/// Exponent at k ("^2", "^-1", a superscript), and moves k behind it; 1 if none.
int read_exponent(const std::string& text, std::size_t& k) {
  for (const int power : {2, 3}) {
    const char* const sign = power == 2 ? "\u00b2" : "\u00b3";
    if (!starts_with(text, k, sign)) continue;
    k += std::string(sign).size();
    return power;
  }
  if (k >= text.size() || text[k] != '^') return 1;
  const std::size_t digit = k + (k + 1 < text.size() && text[k + 1] == '-' ? 2 : 1);
  const auto is_digit = [&](std::size_t at) {
    return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at]));
  };
  if (!is_digit(digit) || is_digit(digit + 1)) return 1;
  const int power = (text[digit] - '0') * (digit == k + 2 ? -1 : 1);
  k = digit + 1;
  return power;
}

void multiply_by(Unit& unit, const Unit& factor, int power) {
  for (int i = 0; i < std::min(std::abs(power), max_exponent); ++i) {
    unit.multiply *= power > 0 ? factor.multiply : factor.divide;
    unit.divide *= power > 0 ? factor.divide : factor.multiply;
  }
  for (int b = 0; b < Dimension::num_bases; ++b) unit.dimension.exponents[b] += power * factor.dimension.exponents[b];
}

/// "m^2*kg/s"
std::string formula(const Dimension& dimension) {
  static const char* const bases[] = {"m", "kg", "s", "K", "rad"};
  std::string text;
  for (int b = 0; b < Dimension::num_bases; ++b) {
    const double power = dimension.exponents[b];
    if (power == 0 || !std::isfinite(power)) continue;
    text += (text.empty() ? "" : " ") + std::string(bases[b]) + (power == 1 ? "" : fmt::format("^{:.3g}", power));
  }
  return text;
}

const NamedDimension* named(const Dimension& dimension) {
  for (const NamedDimension& entry : named_dimensions())
    if (entry.dimension.exponents == dimension.exponents) return &entry;
  for (const NamedDimension& entry : named_dimensions())
    if (entry.dimension.same_but_angle(dimension)) return &entry;
  return nullptr;
}

}  // namespace

bool Dimension::is_angle() const { return exponents == cgcontact::angle.exponents; }

bool Dimension::same_but_angle(const Dimension& other) const {
  return std::equal(exponents.begin(), exponents.begin() + angle, other.exponents.begin());
}

std::size_t length_of_unit(const std::string& text, std::size_t begin, Unit* unit, std::vector<std::string>* names) {
  Unit product;
  std::size_t k = begin, end = begin;
  int sign = 1;
  if (starts_with(text, k, "1/")) {
    sign = -1;
    k += 2;
  }
  while (true) {
    const std::size_t length = length_of_name(text, k);
    const Unit* const factor = length > 0 ? unit_of_name(text.substr(k, length)) : nullptr;
    const std::size_t behind = k + length;
    const bool longer = behind < text.size() && (std::isdigit(static_cast<unsigned char>(text[behind])) ||
                                                 text[behind] == '_' || text[behind] == '(');
    if (!factor || longer) break;
    if (names && k > begin) names->push_back(text.substr(k, length));
    k = behind;
    multiply_by(product, *factor, sign * read_exponent(text, k));
    end = k;
    k = skip_blanks(text, k);
    const bool dot = starts_with(text, k, "\u00b7");
    if (k >= text.size() || !(text[k] == '*' || text[k] == '/' || dot)) break;
    sign = text[k] == '/' ? -1 : 1;
    k = skip_blanks(text, k + (dot ? 2 : 1));
  }
  if (unit) *unit = product;
  return end - begin;
}

Unit unit_named(const std::string& text) {
  Unit unit;
  if (length_of_unit(text, 0, &unit) != text.size()) throw std::logic_error("\"" + text + "\" is no unit");
  return unit;
}

const std::vector<std::string>& names_of_units() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const NamedUnit& entry : all_units()) result.emplace_back(entry.name);
    return result;
  }();
  return names;
}

std::string name_of(const Dimension& dimension) {
  const NamedDimension* const entry = named(dimension);
  return entry ? entry->name : "of the dimension " + formula(dimension);
}

std::string units_of(const Dimension& dimension) {
  const NamedDimension* const entry = named(dimension);
  return entry ? entry->units : formula(dimension);
}

}  // namespace cgcontact
