#include "core/expressions/unit_check.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <system_error>

namespace cgcontact {

namespace {

std::string allowed_units(const Unit& unit, const std::string& allowed) {
  const std::string units = units_of(unit.dimension);
  return allowed + (units.empty() ? "; no unit" : "; units: " + units);
}

/// Number at k, without a sign: where it ends; k if none.
std::size_t end_of_number(const std::string& text, std::size_t k) {
  if (k >= text.size() || !(std::isdigit(static_cast<unsigned char>(text[k])) || text[k] == '.')) return k;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + k, text.data() + text.size(), value);
  return error == std::errc() ? static_cast<std::size_t>(end - text.data()) : k;
}

/// Returns whether a number ends before k, not in a quotient or a power itself.
bool is_behind_number(const std::string& text, std::size_t k) {
  while (k > 0 && text[k - 1] == ' ') --k;
  const std::size_t end = k;
  while (k > 0 && (std::isdigit(static_cast<unsigned char>(text[k - 1])) || text[k - 1] == '.')) --k;
  if (k == end) return false;
  while (k > 0 && text[k - 1] == ' ') --k;
  return k == 0 || std::string("(+-*,?:\"").find(text[k - 1]) != std::string::npos;
}

/// Explains the unit of a divisor ("188/4 N") that fits as that of the quotient, and how to write it; "" if it is
/// something else.
std::string unit_of_divisor(const std::string& text, const Dimension& found, const Dimension& wanted) {
  for (std::size_t slash = text.find('/'); slash != std::string::npos; slash = text.find('/', slash + 1)) {
    const std::size_t number = text.find_first_not_of(' ', slash + 1), end = end_of_number(text, number);
    if (end == number) continue;
    const std::size_t begin = text.find_first_not_of(' ', end);
    Unit unit;
    const std::size_t length = begin == std::string::npos ? 0 : length_of_unit(text, begin, &unit);
    if (length == 0) continue;
    Dimension moved = found;
    for (int b = 0; b < Dimension::num_bases; ++b) moved.exponents[b] += 2 * unit.dimension.exponents[b];
    if (!(wanted.is_angle() ? moved.is_angle() : moved.same_but_angle(wanted))) continue;
    const std::string divisor = text.substr(number, end - number), name = text.substr(begin, length),
                      before = text.substr(0, text.find_last_not_of(' ', slash - 1) + 1),
                      behind = text.substr(begin + length);
    const std::string better = is_behind_number(text, slash) ? before + " " + name + "/" + divisor + behind
                                                             : before + "/" + divisor + "*1 " + name + behind;
    return fmt::format(": a unit belongs to the one number before it, so that the divisor is {0} {1}; write {2}",
                       divisor, name, better);
  }
  return "";
}

/// Returns the weight of a mass that stands for it ("50 kg" as a force, "5 kg/cm^2" as a pressure); "" if it is
/// something else.
std::string weight_of_mass(const Dimension& found, const Dimension& wanted) {
  Dimension weight = found;
  weight.exponents[Dimension::length] += 1;
  weight.exponents[Dimension::time] -= 2;
  return weight.same_but_angle(wanted) ? ": 1 kg weighs 9.80665 N, write N in the place of the mass" : "";
}

}  // namespace

double value_in(const Unit& unit, const Quantity& quantity, const SourceLocation& location, const std::string& text,
                const std::string& allowed) {
  if (!quantity.has_units || !quantity.dimension) return quantity.value;
  const Dimension& dimension = *quantity.dimension;
  const bool pure = dimension.exponents == Dimension{}.exponents;
  if (unit.dimension.is_angle() && pure) return quantity.value;
  const bool fits = unit.dimension.is_angle() ? dimension.is_angle() : dimension.same_but_angle(unit.dimension);
  if (!fits)
    throw InputError(location, text,
                     "is " + name_of(dimension) + ", not " + name_of(unit.dimension) +
                         weight_of_mass(dimension, unit.dimension) + unit_of_divisor(text, dimension, unit.dimension),
                     allowed_units(unit, allowed));
  const int angle = Dimension::angle;
  if (!unit.dimension.is_angle() && unit.dimension.exponents[angle] != 0 && dimension.exponents[angle] == 0)
    throw InputError(location, text, "is " + name_of(dimension) + ", which may mean revolutions or radians",
                     allowed_units(unit, allowed));
  return unit.from_si(quantity.value);
}

}  // namespace cgcontact
