#include "core/expressions/expression_dimension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace cgcontact {
namespace {

using FoundDimension = std::optional<Dimension>;

bool is_pure(const FoundDimension& found) { return !found || found->same_but_angle({}); }

/// Product of powers of two dimensions; zero times anything is zero.
FoundDimension product(const FoundDimension& a, const FoundDimension& b, double power) {
  if (!a || !b) return std::nullopt;
  Dimension result = *a;
  for (int base = 0; base < Dimension::num_bases; ++base) result.exponents[base] += power * b->exponents[base];
  return result;
}

/// Finds the common dimension of operands. `sign`: what stands between them.
FoundDimension common(const FoundDimension& a, const FoundDimension& b, const std::string& sign) {
  if (!a) return b;
  if (!b) return a;
  if (!a->same_but_angle(*b)) throw MixedDimensions(fmt::format("{} {} {}", name_of(*a), sign, name_of(*b)));
  Dimension result = *a;
  double& angle = result.exponents[Dimension::angle];
  if (angle != b->exponents[Dimension::angle]) angle = std::numeric_limits<double>::quiet_NaN();
  return result;
}

/// Descends by the precedence of muParser: ?:, ||, &&, comparisons, sums, products, signs, powers.
class DimensionParser {
 public:
  DimensionParser(const std::string& text, const NamesAndPowers& names) : text_(text), names_(names) {}

  FoundDimension whole() { return condition(); }

  std::vector<std::pair<std::string, std::string>> comparisons;  ///< by size, found so far

 private:
  FoundDimension condition() {
    const FoundDimension chosen_by = either();
    if (!take("?")) return chosen_by;
    require_truth(chosen_by, "?");
    const FoundDimension first = condition();
    take(":");
    return common(first, condition(), ":");
  }

  FoundDimension either() { return truths("||", &DimensionParser::both); }
  FoundDimension both() { return truths("&&", &DimensionParser::comparison); }

  FoundDimension truths(const char* sign, FoundDimension (DimensionParser::*operand)()) {
    FoundDimension left = (this->*operand)();
    while (take(sign)) {
      require_truth(left, sign);
      require_truth((this->*operand)(), sign);
      left = Dimension{};
    }
    return left;
  }

  FoundDimension comparison() {
    const std::size_t begin = at_;
    FoundDimension left = sum();
    std::size_t end = at_;
    for (std::string sign; !(sign = take_one_of({"<=", ">=", "==", "!=", "<", ">"})).empty(); left = Dimension{}) {
      const std::size_t right = at_;
      common(left, sum(), sign);
      if (sign[0] == '<' || sign[0] == '>')
        comparisons.emplace_back(text_.substr(begin, end - begin), text_.substr(right, at_ - right));
      end = at_;
    }
    return left;
  }

  FoundDimension sum() {
    FoundDimension left = quotient();
    for (std::string sign; !(sign = take_one_of({"+", "-"})).empty();) left = common(left, quotient(), sign);
    return left;
  }

  FoundDimension quotient() {
    FoundDimension left = power();
    for (std::string sign; !(sign = take_one_of({"*", "/"})).empty();)
      left = product(left, power(), sign == "*" ? 1 : -1);
    return left;
  }

  FoundDimension power() {
    while (!take_one_of({"+", "-"}).empty()) {
    }
    const FoundDimension base = primary();
    if (!take("^")) return base;
    const std::size_t begin = at_;
    const FoundDimension exponent = power();
    if (!is_pure(exponent)) throw MixedDimensions("an exponent that is " + name_of(*exponent));
    if (!base) return base;
    if (const std::optional<double> value = names_.value_of(text_.substr(begin, at_ - begin)))
      return product(Dimension{}, base, *value);
    if (!is_pure(base)) throw MixedDimensions(name_of(*base) + " ^ an exponent that is not constant");
    return Dimension{};
  }

  FoundDimension primary() {
    if (take("(")) {
      const FoundDimension inside = condition();
      take(")");
      return inside;
    }
    const std::size_t begin = at_;
    if (!starts_name()) return number();
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
    const std::string name = text_.substr(begin, at_ - begin);
    return take("(") ? called(name) : names_.dimension_of(name);
  }

  FoundDimension number() {
    char* end = nullptr;
    const double value = std::strtod(text_.c_str() + at_, &end);
    const std::size_t length = end - (text_.c_str() + at_);
    at_ += std::max<std::size_t>(length, 1);
    return value == 0 ? FoundDimension() : Dimension{};
  }

  FoundDimension called(const std::string& function) {
    const std::size_t begin = at_;
    std::vector<FoundDimension> arguments;
    do {
      arguments.push_back(condition());
    } while (take(","));
    if (function == "sign") comparisons.emplace_back(text_.substr(begin, at_ - begin), "0");
    take(")");
    const auto is = [&](const std::vector<std::string>& names) {
      return std::find(names.begin(), names.end(), function) != names.end();
    };
    FoundDimension all = arguments[0];
    if (is({"min", "max", "sum", "avg", "abs", "atan2"})) {
      for (std::size_t k = 1; k < arguments.size(); ++k) all = common(all, arguments[k], "beside");
      return function == "atan2" ? Dimension{} : all;
    }
    if (function == "sqrt") return all ? product(Dimension{}, all, 0.5) : all;
    if (function == "sign") return Dimension{};
    if (!is_pure(all))
      throw MixedDimensions(fmt::format("{} of {} in place of a pure number", function, name_of(*all)));
    return Dimension{};
  }

  void require_truth(const FoundDimension& found, const char* sign) const {
    if (!is_pure(found))
      throw MixedDimensions(fmt::format("{} in place of a condition beside {}", name_of(*found), sign));
  }

  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  bool starts_name() {
    skip_blanks();
    return at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_');
  }

  bool take(const std::string& sign) {
    skip_blanks();
    if (text_.compare(at_, sign.size(), sign) != 0) return false;
    at_ += sign.size();
    return true;
  }

  /// The sign that was taken, or "".
  std::string take_one_of(const std::vector<std::string>& signs) {
    const auto found = std::find_if(signs.begin(), signs.end(), [&](const std::string& sign) { return take(sign); });
    return found == signs.end() ? "" : *found;
  }

  const std::string& text_;
  const NamesAndPowers& names_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<Dimension> find_dimension(const std::string& text, const NamesAndPowers& names) {
  return DimensionParser(text, names).whole();
}

std::vector<std::pair<std::string, std::string>> find_comparisons(const std::string& text) {
  NamesAndPowers anything;  // of no dimension: all fits
  anything.dimension_of = [](const std::string&) { return std::nullopt; };
  anything.value_of = [](const std::string&) { return std::nullopt; };
  DimensionParser parser(text, anything);
  parser.whole();
  return parser.comparisons;
}

}  // namespace cgcontact
