#include "core/cad/step_references.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <vector>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

struct Reference {
  std::uint64_t to, from;  ///< 0: from none
  int line;
};

/// Goes through the text of ISO 10303-21 by its tokens.
class References {
 public:
  explicit References(const std::string& text) : text_(text) {}

  void collect() {
    bool begins = true;  // a statement
    for (at_ = 0; at_ < text_.size();) {
      const char c = text_[at_];
      if (c == '\'' || c == '"') {
        skip_to(text_.find(c, at_ + 1), 1);
      } else if (c == '/' && text_.compare(at_, 2, "/*") == 0) {
        skip_to(text_.find("*/", at_ + 2), 2);
      } else if (c == '<') {  // names of anchors and positions in other files
        skip_to(text_.find('>', at_), 1);
      } else if (c == '#' && at_ + 1 < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_ + 1]))) {
        const int line = line_;
        const std::uint64_t number = take_number();
        if (begins && next_is('=')) {
          defined_.push_back(number);
          current_ = number;
        } else {
          references_.push_back({number, current_, line});
        }
        begins = false;
      } else {
        if (c == ';') {
          begins = true;
          current_ = 0;
        } else if (!std::isspace(static_cast<unsigned char>(c))) {
          begins = false;
        }
        skip_to(at_, 1);
      }
    }
    std::sort(defined_.begin(), defined_.end());
  }

  /// nullptr: none.
  const Reference* first_dangling() const {
    for (const Reference& reference : references_)
      if (!std::binary_search(defined_.begin(), defined_.end(), reference.to)) return &reference;
    return nullptr;
  }

 private:
  /// Skips to `length` characters behind a position; to the end if none.
  void skip_to(std::size_t index, std::size_t length) {
    const std::size_t end = index == std::string::npos ? text_.size() : std::min(index + length, text_.size());
    line_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                         text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    at_ = end;
  }

  std::uint64_t take_number() {
    std::uint64_t number = 0;
    for (++at_; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])); ++at_) {
      const auto digit = static_cast<std::uint64_t>(text_[at_] - '0');
      const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
      number = number > (most - digit) / 10 ? most : 10 * number + digit;
    }
    return number;
  }

  bool next_is(char wanted) const {
    std::size_t k = at_;
    while (k < text_.size() && std::isspace(static_cast<unsigned char>(text_[k]))) ++k;
    return k < text_.size() && text_[k] == wanted;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::uint64_t current_ = 0;
  std::vector<std::uint64_t> defined_;
  std::vector<Reference> references_;
};

}  // namespace

void check_step_references(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  References references(text);
  references.collect();
  const Reference* const dangling = references.first_dangling();
  if (!dangling) return;
  throw InputError(fmt::format(
      "{}:{}: {}refers to #{}, which the file does not define: it is damaged or cut off (allowed: a file "
      "that is whole)",
      file, dangling->line, dangling->from > 0 ? fmt::format("#{} ", dangling->from) : std::string(), dangling->to));
}

}  // namespace cgcontact
