/// Several mistakes of one input, reported together.
#pragma once

#include <cstddef>
#include <stdexcept>
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

/// An entry that cannot be read because of a mistake that is known: no mistake of its own.
struct FollowingMistake : std::logic_error {
  FollowingMistake() : std::logic_error("an entry cannot be read because of a mistake that nobody told") {}
};

/// Mistakes of entries that do not depend on each other: each is read, whether or not another has one.
class MistakeList {
 public:
  /// False: the entry has a mistake, or cannot be read because of another one.
  template <typename Task>
  bool attempt(const Task& task) {
    try {
      task();
      return true;
    } catch (const FollowingMistake&) {
      has_following_ = true;
    } catch (const InputError& mistake) {
      for (const std::string& message : messages_of(mistake)) messages_.push_back(message);
    }
    return false;
  }

  /// Number of mistakes.
  std::size_t size() const { return messages_.size(); }

  /// Throws all mistakes together (`file`: see Mistakes), or FollowingMistake where an entry could not be read because
  /// of one that somebody else knows.
  void throw_if_any(const std::string& file) const;

 private:
  std::vector<std::string> messages_;
  bool has_following_ = false;
};

}  // namespace cgcontact
