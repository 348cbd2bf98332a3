/// Quantities: numbers with what is known about their dimension, and whether they fit a key.
#pragma once

#include <optional>
#include <string>

#include "core/base/errors/errors.hpp"
#include "core/expressions/units.hpp"

namespace cgcontact {

/// A number in SI units, and what is known about its dimension.
struct Quantity {
  Quantity() = default;
  Quantity(double in_si) : value(in_si) {}  // NOLINT: numbers without a unit are quantities
  Quantity(double in_si, const Dimension& of, bool given) : value(in_si), dimension(of), has_units(given) {}
  operator double() const { return value; }  // NOLINT

  double value = 0;
  std::optional<Dimension> dimension;  ///< none: a number without a unit, or zero
  bool has_units = false;              ///< units are written in the scene; else x, y, z or a computed force are meant
};

/// Returns the value in the unit of a key. Throws InputError if the quantity has units and another dimension;
/// `allowed`: what the key takes.
double value_in(const Unit& unit, const Quantity& quantity, const SourceLocation& location, const std::string& text,
                const std::string& allowed);

}  // namespace cgcontact
