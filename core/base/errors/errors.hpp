/// Errors that a user can cause, with their location in the scene.
#pragma once

#include <stdexcept>
#include <string>

namespace cgcontact {

/// Location in a scene file; line 0 means "no line known" (for example a value given by --set).
struct SourceLocation {
  std::string file;
  int line = 0;
  std::string key;  ///< dotted key, for example body[0].material.E
};

/// Formats a text in one line for a terminal: no control characters, no bytes that are not UTF-8, not too long (bytes).
std::string printable(const std::string& text, std::size_t longest = 4000);

/// Bad input: what() is one complete message "file:line: key = value: problem (allowed: ...)".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// value and allowed may be empty.
  InputError(const SourceLocation& location, const std::string& value, const std::string& problem,
             const std::string& allowed = {});
};

}  // namespace cgcontact
