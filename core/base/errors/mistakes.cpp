#include "core/base/errors/mistakes.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "core/base/errors/suggest.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t max_mistakes = 20;  // that a terminal shows at once

/// Line number of a message "file:line: ..."; 0: it has none.
int line_of(const std::string& message, const std::string& file) {
  const std::string begin = file + ":";
  return message.compare(0, begin.size(), begin) == 0 ? std::atoi(message.c_str() + begin.size()) : 0;
}

/// Without the numbers of elements: those of copies have one line and one mistake.
std::string without_numbers(const std::string& message) {
  std::string text;
  bool inside = false;
  for (const char c : message) {
    inside = inside ? c != ']' : c == '[';
    if (!inside || c == '[' || !std::isdigit(static_cast<unsigned char>(c))) text += c;
  }
  return text;
}

std::vector<std::string> in_order(const std::vector<std::string>& messages, const std::string& file) {
  std::vector<std::string> lines;
  std::set<std::string> seen;
  for (const std::string& message : messages)
    if (seen.insert(without_numbers(message)).second) lines.push_back(message);
  std::stable_sort(lines.begin(), lines.end(),
                   [&](const std::string& a, const std::string& b) { return line_of(a, file) < line_of(b, file); });
  if (const std::size_t all = lines.size(); all > max_mistakes) {
    lines.resize(max_mistakes);
    lines.push_back("and " + std::to_string(all - max_mistakes) + " more mistakes");
  }
  if (lines.empty()) throw std::logic_error("no mistakes to tell together");
  return lines;
}

}  // namespace

Mistakes::Mistakes(const std::vector<std::string>& messages, const std::string& file)
    : Mistakes(in_order(messages, file)) {}

Mistakes::Mistakes(std::vector<std::string> lines) : InputError(join(lines, "\n")), messages_(std::move(lines)) {}

std::vector<std::string> messages_of(const InputError& error) {
  const auto* const several = dynamic_cast<const Mistakes*>(&error);
  return several ? several->messages() : std::vector<std::string>{error.what()};
}

void MistakeList::throw_if_any(const std::string& file) const {
  if (!messages_.empty()) throw Mistakes(messages_, file);
  if (has_following_) throw FollowingMistake();
}

}  // namespace cgcontact
