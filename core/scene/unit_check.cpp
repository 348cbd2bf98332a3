#include "core/scene/unit_check.hpp"

#include <cmath>
#include <limits>

namespace cgcontact {

namespace {

constexpr int binary_digits = 12;    // of the change of units: a power of two, exact in sums, products, quotients
constexpr int parts = 12;            // exponents are multiples of 1/12: roots up to the fourth and their products
constexpr double same_power = 1e-9;  // rounding of pow()
const char* const base_names[] = {"length", "mass", "time", "temperature", "angle"};

std::string allowed_units(const Unit& unit, const std::string& allowed) {
  const std::string units = units_of(unit.dimension);
  return allowed + (units.empty() ? "; no unit" : "; units: " + units);
}

}  // namespace

double scale_of(const Dimension& dimension, const UnitScales& scales) {
  double factor = 1;
  for (int b = 0; b < Dimension::num_bases; ++b)
    if (std::isfinite(dimension.exponents[b])) factor *= std::pow(scales[b], dimension.exponents[b]);
  return factor;
}

FoundDimension find_dimension(const std::function<double(const UnitScales&)>& evaluate) {
  UnitScales scales;
  scales.fill(1);
  const double value = evaluate(scales);
  FoundDimension found;
  if (!(std::isfinite(value) && value != 0)) return found;
  Dimension dimension;
  for (int b = 0; b < Dimension::num_bases; ++b) {
    scales[b] = std::ldexp(1.0, binary_digits);
    const double power = std::log2(evaluate(scales) / value) / binary_digits;
    scales[b] = 1;
    dimension.exponents[b] = std::round(power * parts) / parts;
    if (std::abs(power - dimension.exponents[b]) < same_power) continue;
    dimension.exponents[b] = std::numeric_limits<double>::quiet_NaN();
    if (b == Dimension::angle) continue;
    found.mixed = base_names[b];
    return found;
  }
  found.dimension = dimension;
  return found;
}

double value_in(const Unit& unit, const Quantity& quantity, const SourcePlace& place, const std::string& text,
                const std::string& allowed) {
  if (!quantity.has_units || !quantity.dimension) return quantity.value;
  const Dimension& dimension = *quantity.dimension;
  const bool pure = dimension.exponents == Dimension{}.exponents;
  if (unit.dimension.is_angle() && pure) return quantity.value;
  const bool fits = unit.dimension.is_angle() ? dimension.is_angle() : dimension.same_but_angle(unit.dimension);
  if (!fits)
    throw InputError(place, text, "is " + name_of(dimension) + ", not " + name_of(unit.dimension),
                     allowed_units(unit, allowed));
  return unit.from_si(quantity.value);
}

}  // namespace cgcontact
