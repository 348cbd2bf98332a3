/// Dimension of an expression, by the rules of algebra: operands of a sum, of a comparison, of `min` and `max` and both
/// values of a condition have the same one, powers multiply it, other functions take pure numbers and angles.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/expressions/units.hpp"

namespace cgcontact {

/// Operands of an expression that do not fit together: "a length > a force".
struct MixedDimensions : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Values of the names and exponents of an expression.
struct NamesAndPowers {
  /// Dimension of a variable or constant; none: it is zero and fits everything.
  std::function<std::optional<Dimension>(const std::string& name)> dimension_of;
  /// Value of an exponent; none: it is not constant.
  std::function<std::optional<double>(const std::string& text)> value_of;
};

/// Finds the dimension of an expression; none: the value is zero whatever its operands are. An angle that is no power
/// any more (an angle plus a number) is NaN. `text`: without units, of valid syntax. Throws MixedDimensions.
std::optional<Dimension> find_dimension(const std::string& text, const NamesAndPowers& names);

/// Returns both sides of every comparison by size in an expression; what `sign` takes is compared with 0.
std::vector<std::pair<std::string, std::string>> find_comparisons(const std::string& text);

}  // namespace cgcontact
