/// The dimension of an expression, found by changing the units: a value of the dimension length doubles with every
/// length in it, and what adds a length to a force follows no power.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/errors.hpp"
#include "core/scene/units.hpp"

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

/// By how much the units of the bases are changed.
using UnitScales = std::array<double, Dimension::num_bases>;
/// The factor for a quantity of this dimension. An angle that is no power any more (the sine of one) counts as none.
double scale_of(const Dimension& dimension, const UnitScales& scales);

struct FoundDimension {
  std::optional<Dimension> dimension;  ///< none: the value is zero or not finite, or `mixed` says why
  std::string mixed;                   ///< the base that different numbers have to different powers: "length", ...
};
/// Of the value that `evaluate` returns. The angle is NaN where a value is no power of it.
FoundDimension find_dimension(const std::function<double(const UnitScales&)>& evaluate);

/// The value in the unit of a key. Throws InputError if the quantity has units and another dimension; `allowed`: what
/// the key takes.
double value_in(const Unit& unit, const Quantity& quantity, const SourcePlace& place, const std::string& text,
                const std::string& allowed);

}  // namespace cgcontact
