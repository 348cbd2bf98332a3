#include "core/errors.hpp"

namespace cgcontact {

namespace {

std::string format_message(const SourcePlace& place, const std::string& value, const std::string& problem,
                           const std::string& allowed) {
  std::string text = place.file;
  if (place.line > 0) text += ":" + std::to_string(place.line);
  if (!text.empty()) text += ": ";
  if (!place.key.empty()) {
    text += place.key;
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

InputError::InputError(const SourcePlace& place, const std::string& value, const std::string& problem,
                       const std::string& allowed)
    : std::runtime_error(format_message(place, value, problem, allowed)) {}

}  // namespace cgcontact
