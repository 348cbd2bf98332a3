#include "core/program/study_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

[[noreturn]] void refuse(const std::string& value, const std::string& problem, const std::string& allowed) {
  throw InputError(fmt::format("\"{}\" {} (allowed: {})", value, problem, allowed));
}

double number(const std::string& text, const std::string& allowed) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool decimal = text.find_first_not_of("+-.0123456789eE") == std::string::npos;
  if (text.empty() || *end != '\0' || !decimal || !std::isfinite(value)) refuse(text, "is not a number", allowed);
  return value;
}

int integer(const std::string& text, int largest, const std::string& what) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > largest)
    refuse(text, "is not a " + what, fmt::format("an integer from 1 to {}", largest));
  return value;
}

/// Different texts may be the same number. may_be_percent: "5%" is one.
void expect_different(const std::vector<std::string>& numbers, const std::string& allowed, bool may_be_percent) {
  std::vector<double> seen;
  for (const std::string& text : numbers) {
    const bool percent = may_be_percent && text.back() == '%';
    const double value =
        percent ? number(trimmed(text.substr(0, text.size() - 1)), allowed) / 100 : number(text, allowed);
    if (std::find(seen.begin(), seen.end(), value) != seen.end()) refuse(text, "is there twice", allowed);
    seen.push_back(value);
  }
}

/// Returns whether the text can stand in a file name.
bool is_name(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-' || c == '.';
  });
}

}  // namespace

std::vector<std::string> parse_list(const std::string& text, const std::string& allowed) {
  if (trimmed(text).empty()) refuse(text, "is an empty list", allowed);
  std::vector<std::string> entries;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string entry = trimmed(text.substr(begin, end - begin));
    if (entry.empty()) refuse(text, "has an empty entry", allowed);
    if (std::find(entries.begin(), entries.end(), entry) != entries.end()) refuse(entry, "is there twice", allowed);
    entries.push_back(entry);
    begin = end + 1;
  }
  return entries;
}

std::pair<std::string, std::vector<std::string>> parse_vary(const std::string& text) {
  const std::string allowed = "KEY=NUMBER,NUMBER,..., for example n=8,16,32 or accuracy.pressure=5%,2%,1%";
  const std::size_t equal = text.find('=');
  const std::string key = trimmed(text.substr(0, equal));
  if (equal == std::string::npos || key.empty()) refuse(text, "has no key or no values", allowed);
  std::vector<std::string> numbers = parse_list(text.substr(equal + 1), allowed);
  expect_different(numbers, allowed, true);
  return {key, std::move(numbers)};
}

std::vector<std::string> parse_factors(const std::string& text) {
  const std::string allowed = "numbers > 0 that divide the cell sizes, for example 1,2,4";
  std::vector<std::string> factors = parse_list(text, allowed);
  for (const std::string& factor : factors)
    if (number(factor, allowed) <= 0) refuse(factor, "is out of range", allowed);
  expect_different(factors, allowed, false);
  return factors;
}

int parse_threads(const std::string& text) { return integer(text, max_threads, "number of threads"); }

std::vector<int> parse_thread_list(const std::string& text) {
  std::vector<int> list;
  for (const std::string& entry : parse_list(text, "numbers of threads, for example 1,2")) {
    const int threads = parse_threads(entry);
    if (std::find(list.begin(), list.end(), threads) != list.end())
      refuse(entry, "is there twice", "different numbers of threads");
    list.push_back(threads);
  }
  return list;
}

std::vector<StudyOptions::Backend> parse_backends(const std::string& text) {
  const std::string allowed = "NAME=PROGRAM,NAME=PROGRAM,..., other builds of this program";
  std::vector<StudyOptions::Backend> backends;
  for (const std::string& entry : parse_list(text, allowed)) {
    const std::size_t equal = entry.find('=');
    if (equal == std::string::npos) refuse(entry, "has no \"=\"", allowed);
    StudyOptions::Backend backend{trimmed(entry.substr(0, equal)), trimmed(entry.substr(equal + 1))};
    if (!is_name(backend.name)) refuse(entry, "has no good name", "letters, digits, \"_\", \"-\" and \".\"");
    for (const StudyOptions::Backend& other : backends)
      if (other.name == backend.name) refuse(backend.name, "is there twice", allowed);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(backend.program, ignored) || access(backend.program.c_str(), X_OK) != 0)
      refuse(backend.program, "is not a program that can be run", "an executable file");
    backend.program = std::filesystem::absolute(backend.program).string();
    backends.push_back(backend);
  }
  return backends;
}

int parse_repeat(const std::string& text) { return integer(text, max_repeats, "number of repetitions"); }

}  // namespace cgcontact
