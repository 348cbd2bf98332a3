#include "core/base/errors/errors.hpp"

#include <algorithm>

namespace cgcontact {

std::string printable(const std::string& text, std::size_t longest) {
  std::string result;
  for (std::size_t k = 0; k < text.size();) {
    const auto c = static_cast<unsigned char>(text[k]);
    std::size_t length = c < 0x80                ? 1
                         : c >= 0xc2 && c < 0xe0 ? 2
                         : c >= 0xe0 && c < 0xf0 ? 3
                         : c >= 0xf0 && c < 0xf5 ? 4
                                                 : 0;
    for (std::size_t i = 1; i < length; ++i)
      if (k + i >= text.size() || (static_cast<unsigned char>(text[k + i]) & 0xc0) != 0x80) length = 0;
    // Longer than needed, a half of a pair of UTF-16, beyond the last letter.
    if (const auto second = static_cast<unsigned char>(length > 2 ? text[k + 1] : 0);
        length > 2 && ((c == 0xe0 && second < 0xa0) || (c == 0xed && second >= 0xa0) || (c == 0xf0 && second < 0x90) ||
                       (c == 0xf4 && second >= 0x90)))
      length = 0;
    if (result.size() + length > longest) return result + "...";
    const bool shown = length > 1 || (length == 1 && c >= ' ' && c != 0x7f);
    result += shown ? text.substr(k, length) : std::string(length == 1 ? " " : "?");
    k += std::max<std::size_t>(length, 1);
  }
  return result;
}

namespace {

constexpr std::size_t longest_value = 80, longest_text = 1500, longest_location = 1000;

std::string format_message(const SourceLocation& location, const std::string& value, const std::string& problem,
                           const std::string& allowed) {
  std::string text =
      location.file.size() > longest_location ? printable(location.file, longest_location) : location.file;
  if (location.line > 0) text += ":" + std::to_string(location.line);
  if (!text.empty()) text += ": ";
  if (!location.key.empty()) {
    text += location.key;
    if (!value.empty()) text += " = " + value;
    text += ": ";
  } else if (!value.empty()) {
    text += value + ": ";
  }
  text += problem;
  if (!allowed.empty()) text += " (allowed: " + allowed + ")";
  return text;
}

}  // namespace

InputError::InputError(const SourceLocation& location, const std::string& value, const std::string& problem,
                       const std::string& allowed)
    : std::runtime_error(format_message(location, printable(value, longest_value), printable(problem, longest_text),
                                        printable(allowed, longest_text))) {}

}  // namespace cgcontact
