/// Common base of the settings of all stages. Each struct of options lists its settings once, with key, meaning and
/// range; the scene reader, check() and print() go through that list.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/numbers/types.hpp"
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

/// Wanted relative error; none: not asked for. Scenes write it as 0.01 or "1 %".
using Target = std::optional<double>;

/// Setting that its stage reads by itself, such as a table of names.
struct OwnForm {
  std::function<std::string()> text;  ///< the present value as TOML; empty: none
};

struct Setting {
  std::string key;  ///< under the section of the stage; with a dot in it: of a table there
  std::variant<double*, int*, bool*, std::string*, Target*, std::optional<PathEnds>*, Choice, OwnForm> value;
  std::string meaning;         ///< in one line, for users
  Range range = {};            ///< of numbers
  std::vector<int> only = {};  ///< of integers: just these; empty: all in the range
  std::string if_empty = {};   ///< what an empty text, or no value, means
  bool of_scene = true;        ///< a scene can set it; else it is a constant of the method
};

/// Makes a constant of the method. Its source stands beside the member.
Setting method_constant(const std::string& key, double& value, const std::string& meaning, const Range& range);
Setting method_constant(const std::string& key, int& value, const std::string& meaning, const Range& range);

/// Throws InputError for the first number out of its range: key (under `section`), value, allowed range.
void check_settings(const std::string& section, const std::vector<Setting>& settings);

/// Prints a line "key = value  # default; range; meaning" for each setting, as in a scene; after them the constants of
/// the method. Constants, settings without a value and sections of constants only are comments. `defaults` is the same
/// list of default options.
std::string print_settings(const std::string& section, const std::vector<Setting>& settings,
                           const std::vector<Setting>& defaults);

}  // namespace cgcontact
