/// Common base of the settings of all stages. Each struct of options lists its settings once, with key and range; the
/// scene reader, check() and print() go through that list.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/types.hpp"
#include "core/settings/range.hpp"

namespace cgcontact {

/// One of some names.
struct Choice {
  std::vector<std::string> names;
  std::function<int()> number;          ///< of the present one
  std::function<void(int)> set_number;  ///< makes another one the present one
};

/// Makes a choice by an enum whose values count from 0.
template <class Enum>
Choice choice_of(Enum& value, const std::vector<std::string>& names) {
  return {names, [&value] { return static_cast<int>(value); }, [&value](int k) { value = static_cast<Enum>(k); }};
}

/// Both ends of a path, m.
using PathEnds = std::pair<Vec3, Vec3>;

struct Setting {
  std::string key;  ///< under the section of the stage; with a dot in it: of a table there
  std::variant<double*, int*, bool*, std::string*, std::optional<PathEnds>*, Choice> value;
  Range range = {};            ///< of numbers
  std::vector<int> only = {};  ///< of integers: just these; empty: all in the range
  std::string if_empty = {};   ///< what an empty text, or no line, means
  bool of_scene = true;        ///< a scene can set it; else it is a constant of the method
};

/// Makes a constant of the method. Its source stands beside the member.
Setting method_constant(const std::string& key, double& value, const Range& range);
Setting method_constant(const std::string& key, int& value, const Range& range);

/// Throws InputError for the first number out of its range: key (under `section`), value, allowed range.
void check_settings(const std::string& section, const std::vector<Setting>& settings);

/// Prints a line "key = value" for each setting, as in a scene; after them the constants of the method, as comments.
std::string print_settings(const std::string& section, const std::vector<Setting>& settings);

}  // namespace cgcontact
