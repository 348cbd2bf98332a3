#include "core/expressions/unit_hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <regex>
#include <vector>

#include "core/expressions/units.hpp"

namespace cgcontact {

namespace {

/// Units that scenes do not know because they are no units of the SI, inches or pounds, or have another name here.
struct ForeignUnit {
  std::vector<const char*> names;  ///< in small letters
  const char* instead;             ///< of one of it
};

const std::vector<ForeignUnit>& foreign_units() {
  static const std::vector<ForeignUnit> all{
      {{"kgf", "kp", "kilopond"}, "9.80665 N"},
      {{"tf", "tonf", "mp"}, "9806.65 N"},
      {{"gf", "pond"}, "9.80665 mN"},
      {{"dyn", "dyne"}, "0.01 mN"},
      {{"kip", "kips"}, "1000 lbf"},
      {{"atm"}, "101325 Pa"},
      {{"at"}, "98066.5 Pa"},
      {{"torr", "mmhg"}, "133.322 Pa"},
      {{"hpa"}, "100 Pa"},
      {{"inch", "inches"}, "1 in"},
      {{"foot", "feet"}, "1 ft"},
      {{"yd", "yard", "yards"}, "3 ft"},
      {{"mil", "mils", "thou"}, "0.001 in"},
      {{"micron", "microns", "micrometer", "micrometre"}, "1 um"},
      {{"\u00e5", "angstrom"}, "0.1 nm"},
      {{"grad", "gon"}, "0.9 deg"},
      {{"degc", "\u00b0c", "celsius"}, "1 K, as a difference of temperatures"},
      {{"degf", "\u00b0f"}, "5/9 of 1 K, as a difference of temperatures"},
  };
  return all;
}

std::string small_letters(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

bool is_digit(const std::string& text, std::size_t k) {
  return k < text.size() && std::isdigit(static_cast<unsigned char>(text[k]));
}

const char* const with_a_point = "numbers have a decimal point, and no commas between their digits";

}  // namespace

std::string hint_of_unit(const std::string& word) {
  const std::string letters = small_letters(word);
  for (const ForeignUnit& unit : foreign_units())
    if (std::find(unit.names.begin(), unit.names.end(), letters) != unit.names.end())
      return fmt::format(": 1 {} is {}", word, unit.instead);
  const std::size_t digit = word.find_first_of("0123456789");
  if (digit == std::string::npos || digit + 1 != word.size() || digit == 0) return "";
  const std::string name = word.substr(0, digit);
  const bool known = length_of_unit(name, 0) == name.size();
  const std::string inner = known ? "" : hint_of_unit(name);
  if (!known && inner.empty()) return "";
  return fmt::format(": a power has the sign ^, {}^{}{}", name, word.substr(digit), inner);
}

std::string hint_of_comma(const std::string& text) {
  std::vector<bool> of_function;  // the brackets that are open
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == '(')
      of_function.push_back(k > 0 && (std::isalnum(static_cast<unsigned char>(text[k - 1])) || text[k - 1] == '_'));
    if (text[k] == ')' && !of_function.empty()) of_function.pop_back();
    if (text[k] != ',' || k == 0 || !is_digit(text, k - 1) || !is_digit(text, k + 1)) continue;
    if (of_function.empty() || !of_function.back()) return std::string(": a decimal comma? ") + with_a_point;
  }
  return "";
}

std::string hint_of_line(const std::string& line) {
  static const std::regex comma(R"(=\s*[-+]?\d+,\d)"),
      unit(R"(=\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?\s*(?:[A-Za-z]|\xc2\xb5|\xce\xbc)[A-Za-z]*(?:[*/^][A-Za-z0-9^]+)*))");
  constexpr std::size_t longest = 500;  // std::regex calls itself for every character
  const std::string begin = line.substr(0, longest);
  if (std::regex_search(begin, comma)) return std::string("; a decimal comma? ") + with_a_point;
  if (std::smatch found; std::regex_search(begin, found, unit))
    return fmt::format("; a number with a unit stands in quotes: \"{}\"", found[1].str());
  return "";
}

}  // namespace cgcontact
