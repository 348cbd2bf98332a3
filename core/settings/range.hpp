/// Allowed values of a number.
#pragma once

#include <limits>
#include <string>

namespace cgcontact {

/// Allowed values of a number and the words that say so in an error message.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_allowed = true, max_allowed = true;
  std::string text = "a finite number";
  std::string unit = {};  ///< of the number, where a scene can set it: as core/expressions/units.hpp knows it

  bool contains(double value) const {
    return (min_allowed ? value >= min : value > min) && (max_allowed ? value <= max : value < max);
  }
  static Range any(const std::string& unit = "");
  static Range positive(const std::string& unit = "");
  static Range not_negative(const std::string& unit = "");
  static Range integers(int min, int max);
  static Range from_to(double min, double max, const std::string& text, const std::string& unit = "");
  /// Returns > 0 and < 1.
  static Range fraction();
  /// Returns relative residuals that double precision can reach.
  static Range tolerance();
};

}  // namespace cgcontact
