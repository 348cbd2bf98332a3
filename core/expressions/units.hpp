/// Units that numbers of a scene may have ("20 mm", "100 N/mm^2", "12e-6 1/K") and the dimensions that they stand for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cgcontact {

constexpr double mm = 1e-3;  ///< m: the unit of CAD models

/// Exponents of length, mass, time, temperature and angle.
struct Dimension {
  enum Base { length, mass, time, temperature, angle, num_bases };
  std::array<double, num_bases> exponents{};
  bool is_angle() const;
  /// Angles aside, which count as pure numbers in a product.
  bool same_but_angle(const Dimension& other) const;
};

/// A number in this unit is number * multiply / divide in SI units (two factors: 20 mm are then 0.02 m to the last
/// bit).
struct Unit {
  double multiply = 1, divide = 1;
  Dimension dimension = {};
  double to_si(double value) const { return value * multiply / divide; }
  double from_si(double value) const { return value * divide / multiply; }
};

/// Returns the length of the unit in the text from `begin` on: names with exponents between "*" and "/", or "1/..."; 0
/// if none. `names`: those of the units in it, the first one aside where it does not follow a "/".
std::size_t length_of_unit(const std::string& text, std::size_t begin, Unit* unit = nullptr,
                           std::vector<std::string>* names = nullptr);

/// Returns the unit that a text names, "" a pure number; throws std::logic_error for anything else.
Unit unit_named(const std::string& text);

/// Lists the names of all units.
const std::vector<std::string>& names_of_units();

/// "a length", "a pressure", "a pure number", "of the dimension m^2 kg/s".
std::string name_of(const Dimension& dimension);

/// Lists the units to write behind a number of this dimension: "mm, cm, m, ...", "" for pure numbers.
std::string units_of(const Dimension& dimension);

}  // namespace cgcontact
