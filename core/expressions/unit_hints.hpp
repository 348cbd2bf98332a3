/// Hints at what was meant by texts that look like numbers and units and are none: "N/mm2", "kgf", "1,5 mm".
#pragma once

#include <string>

namespace cgcontact {

/// ": write mm^2", ": 1 kgf is 9.80665 N ...", or "" for a word that nothing is known of.
std::string hint_of_unit(const std::string& word);

/// ": a decimal comma? ..." for a text with a comma between two digits outside of a function's arguments, or "".
std::string hint_of_comma(const std::string& text);

/// Returns the same for one line of a scene file that is not valid TOML; also that numbers with units stand in quotes.
std::string hint_of_line(const std::string& line);

}  // namespace cgcontact
