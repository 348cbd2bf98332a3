/// Several mistakes of one input, reported together.
#pragma once

#include <string>
#include <vector>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

/// One error for all of them: what() has a line for each.
class Mistakes : public InputError {
 public:
  /// Sorts them by their lines in `file` (those without a line first), without repetition; what goes beyond what a
  /// terminal shows is counted. Throws std::logic_error for none.
  Mistakes(const std::vector<std::string>& messages, const std::string& file);

  const std::vector<std::string>& messages() const { return messages_; }

 private:
  explicit Mistakes(std::vector<std::string> lines);

  std::vector<std::string> messages_;
};

/// Returns one message for each mistake of an error.
std::vector<std::string> messages_of(const InputError& error);

}  // namespace cgcontact
