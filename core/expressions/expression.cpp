#include "core/expressions/expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <mutex>

#include "core/base/errors/suggest.hpp"
#include "core/expressions/expression_dimension.hpp"
#include "core/expressions/unit_hints.hpp"

namespace cgcontact {

namespace {

constexpr double e = 2.71828182845904523536;
/// Names of muParser's own constants, with all their digits.
const char* const pi_name = "_pi";
const char* const e_name = "_e";
const char* const axis_names[3] = {"x", "y", "z"};
const char* const operators_help =
    "numbers, x, y, z, pi, _e, parameters, + - * / ^ ( ), comparisons, && ||, a ? b : c, "
    "sqrt abs min max sign exp ln sin cos tan ...";

bool starts_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool continues_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// Number of characters of the decimal number at the start of the text (with exponent), 0 if none.
std::size_t length_of_number(const std::string& text, std::size_t begin) {
  const auto digit = [&](std::size_t k) {
    return k < text.size() && std::isdigit(static_cast<unsigned char>(text[k]));
  };
  std::size_t k = begin;
  if (!digit(k) && !(text[k] == '.' && digit(k + 1))) return 0;
  while (digit(k)) ++k;
  if (k < text.size() && text[k] == '.') ++k;
  while (digit(k)) ++k;
  if (k < text.size() && (text[k] == 'e' || text[k] == 'E')) {
    const std::size_t sign = (k + 1 < text.size() && (text[k + 1] == '+' || text[k + 1] == '-')) ? 1 : 0;
    if (digit(k + 1 + sign)) {
      k += 1 + sign;
      while (digit(k)) ++k;
    }
  }
  return k - begin;
}

/// Calls visit(name, is_called) for every name in the text; a name followed by "(" is called. `with_units`: also for
/// units that may be meant as parameters.
void for_each_name(const std::string& text, const std::function<void(const std::string&, bool)>& visit,
                   bool with_units = false) {
  std::size_t k = 0;
  while (k < text.size()) {
    if (const std::size_t length = length_of_number(text, k)) {
      k += length;
      const std::size_t next = std::min(text.find_first_not_of(" \t", k), text.size());
      std::vector<std::string> doubtful;
      if (const std::size_t unit = length_of_unit(text, next, nullptr, &doubtful)) k = next + unit;
      for (const std::string& name : doubtful)
        if (with_units) visit(name, false);
    } else if (starts_name(text[k])) {
      const std::size_t begin = k;
      while (k < text.size() && continues_name(text[k])) ++k;
      const std::size_t next = text.find_first_not_of(" \t", k);
      visit(text.substr(begin, k - begin), next != std::string::npos && text[next] == '(');
    } else {
      ++k;
    }
  }
}

mu::Parser make_parser(const Constants& constants) {
  mu::Parser parser;
  parser.DefineConst("pi", pi);
  parser.DefineConst(pi_name, pi);
  parser.DefineConst(e_name, e);
  for (const auto& [name, quantity] : constants) parser.DefineConst(name, quantity.value);
  return parser;
}

std::string in_quotes(const std::string& text) { return '"' + text + '"'; }

std::string format_number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

/// Turns a muParser error into an InputError; a name that nobody knows gets a suggestion.
[[noreturn]] void fail(const mu::ParserError& error, const std::string& text, const SourceLocation& location,
                       const Constants& constants, bool with_coordinates) {
  std::vector<std::string> known;
  if (with_coordinates) known.insert(known.end(), std::begin(axis_names), std::end(axis_names));
  known.insert(known.end(), {"pi", pi_name, e_name});
  std::vector<std::string> parameters;
  for (const auto& entry : constants) parameters.push_back(entry.first);
  known.insert(known.end(), parameters.begin(), parameters.end());
  std::vector<std::string> functions;
  const mu::Parser parser;
  for (const auto& entry : parser.GetFunDef()) functions.push_back(entry.first);

  const std::string& token = error.GetToken();
  const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for_each_name(text, [&](const std::string& name, bool is_called) {
    if (!is_called && contains(names_of_units(), name) && !contains(known, name) &&
        did_you_mean(name, parameters).empty())
      throw InputError(location, in_quotes(text),
                       "unknown name " + in_quotes(name) + ": a unit stands behind a number, as in \"20 mm\"",
                       join(known) + ", " + join(functions, " "));
    if (is_called && !contains(functions, name) && !contains(known, name))
      throw InputError(location, in_quotes(text), "unknown function " + in_quotes(name) + did_you_mean(name, functions),
                       join(functions, " "));
  });
  if (error.GetCode() == mu::ecUNASSIGNABLE_TOKEN && !token.empty() && starts_name(token[0])) {
    std::vector<std::string> all = known;
    all.insert(all.end(), functions.begin(), functions.end());
    const bool coordinate = token == "x" || token == "y" || token == "z";
    const std::string hint = hint_of_unit(token);
    std::string why = "unknown name " + in_quotes(token) + (hint.empty() ? did_you_mean(token, all) : hint);
    if (coordinate) why = "must be one number, it cannot depend on " + in_quotes(token);
    if (token == contact_force_name)
      why = in_quotes(token) +
            " is a result: only parameters, pressure, stress and zones of [reference] may use it, in a scene with a "
            "contact pair";
    throw InputError(location, in_quotes(text), why, join(known) + ", " + join(functions, " "));
  }
  std::string message = error.GetCode() == mu::ecINTERNAL_ERROR ? "an operand is missing" : error.GetMsg();
  while (!message.empty() && (message.back() == '.' || message.back() == ' ')) message.pop_back();
  throw InputError(location, in_quotes(text), "not a valid expression: " + message + hint_of_comma(text),
                   operators_help);
}

/// Rejects what muParser would accept although it makes no sense here: nothing at all, assignments, several values.
void check_text(const std::string& text, const SourceLocation& location) {
  const auto fail_with = [&](const std::string& problem) {
    throw InputError(location, in_quotes(text), problem, operators_help);
  };
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) fail_with("empty expression");
  int depth = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char last = k > 0 ? text[k - 1] : ' ', next = k + 1 < text.size() ? text[k + 1] : ' ';
    if (text[k] == '(') ++depth;
    if (text[k] == ')') --depth;
    if (text[k] == ',' && depth == 0)
      fail_with("not a valid expression: one value is needed, not several" + hint_of_comma(text));
    if (text[k] == '=' && next != '=' && last != '=' && last != '<' && last != '>' && last != '!')
      fail_with("not a valid expression: assignment is not possible, equality is ==");
  }
}

/// Text without units: the numbers that have one are constants of their own.
struct TextWithoutUnits {
  std::string text;
  Constants constants;
  bool has_units = false, has_dimensions = false;  ///< of a quantity in it
};

/// A unit behind "*" or "/" must not be meant as a parameter.
void check_not_parameters(const std::string& text, const std::vector<std::string>& names,
                          const SourceLocation& location, const Constants& constants) {
  for (const std::string& name : names)
    if (constants.count(name))
      throw InputError(location, in_quotes(text), in_quotes(name) + " is a parameter and a unit",
                       "another name of the parameter, or brackets around the number and its unit: (5 N)/" + name);
}

/// A word behind a number that is no unit has no meaning.
void check_no_word(const std::string& text, std::size_t begin, const SourceLocation& location) {
  std::size_t end = begin;
  while (end < text.size() && (continues_name(text[end]) || static_cast<unsigned char>(text[end]) >= 0x80)) ++end;
  const std::string word = text.substr(begin, end - begin);
  if (word.empty() || word[0] == '_' || length_of_number(text, begin) > 0) return;
  const bool celsius = word == "C" || word == "\u00b0C" || word == "degC";
  const std::string hint = celsius ? ": temperatures are differences, in K" : hint_of_unit(word);
  throw InputError(location, in_quotes(text),
                   in_quotes(word) + " is no unit" + (hint.empty() ? did_you_mean(word, names_of_units()) : hint),
                   "an operator behind the number, or one of " + join(names_of_units()));
}

TextWithoutUnits without_units(const std::string& text, const SourceLocation& location, const Constants& constants) {
  TextWithoutUnits result{"", constants};
  std::string prefix = "_number";
  while (text.find(prefix) != std::string::npos) prefix += '_';
  int count = 0;
  for (std::size_t k = 0; k < text.size();) {
    std::size_t end = k + 1;
    if (const std::size_t length = length_of_number(text, k)) {
      end = k + length;
      const std::size_t next = std::min(text.find_first_not_of(" \t", end), text.size());
      Unit unit;
      std::vector<std::string> names;
      const std::size_t unit_length = length_of_unit(text, next, &unit, &names);
      if (unit_length == 0) {
        check_no_word(text, next, location);
      } else {
        check_not_parameters(text, names, location, constants);
        const std::string name = prefix + std::to_string(count++);
        result.constants[name] =
            Quantity(unit.to_si(std::strtod(text.substr(k, length).c_str(), nullptr)), unit.dimension, true);
        result.has_units = result.has_dimensions = true;
        result.text += name;
        k = next + unit_length;
        continue;
      }
    } else if (starts_name(text[k])) {
      while (end < text.size() && continues_name(text[end])) ++end;
      const std::string name = text.substr(k, end - k);
      if (const auto found = constants.find(name); found != constants.end()) {
        result.has_units = result.has_units || found->second.has_units;
        result.has_dimensions = result.has_dimensions || found->second.dimension;
      }
    }
    result.text += text.substr(k, end - k);
    k = end;
  }
  return result;
}

/// Value of a text that depends on nothing but constants.
std::optional<double> constant_value(const std::string& text, const Constants& constants) {
  try {
    mu::Parser parser = make_parser(constants);
    parser.SetExpr(text);
    return parser.Eval();
  } catch (const mu::ParserError&) {  // of x, y, z
    return std::nullopt;
  }
}

/// Returns the dimension of the text's value, none: zero whatever its operands are. Throws InputError if it has units
/// and its operands do not fit.
std::optional<Dimension> dimension_of(const TextWithoutUnits& plain, const std::string& text,
                                      const SourceLocation& location, const Constants& constants) {
  NamesAndPowers names;
  names.dimension_of = [&](const std::string& name) -> std::optional<Dimension> {
    if (std::find(std::begin(axis_names), std::end(axis_names), name) != std::end(axis_names))
      return Dimension{{1, 0, 0, 0, 0}};
    const auto found = plain.constants.find(name);
    if (found == plain.constants.end()) return Dimension{};
    if (!found->second.dimension && found->second.value == 0) return std::nullopt;
    return found->second.dimension.value_or(Dimension{});
  };
  names.value_of = [&](const std::string& number) { return constant_value(number, plain.constants); };
  try {
    return find_dimension(plain.text, names);
  } catch (const MixedDimensions& mixed) {
    if (!plain.has_units) return std::nullopt;
    throw InputError(
        location, in_quotes(text),
        "mixes quantities of different dimensions: " + std::string(mixed.what()) + used_constants(text, constants),
        "quantities of one dimension in sums, comparisons, conditions, min and max; beside units, a number "
        "without one is a pure number");
  }
}

/// A parser with the variables it is bound to; never moved.
struct BoundParser {
  explicit BoundParser(const TextWithoutUnits& plain) : parser(make_parser(plain.constants)) {
    for (int k = 0; k < 3; ++k) parser.DefineVar(axis_names[k], &x[k]);
    parser.SetExpr(plain.text);
  }
  BoundParser(const BoundParser&) = delete;
  double evaluate(const Vec3& point) {
    for (int k = 0; k < 3; ++k) x[k] = point[k];
    return parser.Eval();
  }

  double x[3] = {0, 0, 0};
  mu::Parser parser;
};

}  // namespace

/// A text that has been checked, with as many parsers as threads have ever evaluated it at once.
struct Expression::Compiled {
  Compiled(const TextWithoutUnits& plain_in, const std::string& text_in, const SourceLocation& location_in,
           const Constants& constants_in)
      : plain(plain_in), text(text_in), location(location_in), constants(constants_in) {
    try {
      auto parser = std::make_unique<BoundParser>(plain);
      is_constant = parser->parser.GetUsedVar().empty();
      parser->parser.Eval();  // makes the bytecode
      idle.push_back(std::move(parser));
    } catch (const mu::ParserError& error) {
      fail(error, text, location, constants, true);
    }
  }
  Compiled(const Compiled& other) : Compiled(other.plain, other.text, other.location, other.constants) {}
  Compiled& operator=(const Compiled&) = delete;

  double evaluate(const Vec3& point) {
    std::unique_ptr<BoundParser> parser = take();
    const double value = parser->evaluate(point);
    {
      const std::lock_guard<std::mutex> lock(mutex);
      idle.push_back(std::move(parser));
    }
    if (std::isfinite(value)) return value;
    const std::string at = is_constant ? ""
                                       : " at x = " + format_number(point[0]) + ", y = " + format_number(point[1]) +
                                             ", z = " + format_number(point[2]);
    throw InputError(location, in_quotes(text),
                     "the value is " + std::string(std::isnan(value) ? "not a number" : "infinite") + at +
                         used_constants(text, constants) + " (division by zero, or a function outside its domain?)",
                     "finite values wherever the expression is used");
  }

  /// A parser that no other thread uses.
  std::unique_ptr<BoundParser> take() {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!idle.empty()) {
        auto parser = std::move(idle.back());
        idle.pop_back();
        return parser;
      }
    }
    return std::make_unique<BoundParser>(plain);
  }

  TextWithoutUnits plain;
  std::string text;  ///< as it was written
  SourceLocation location;
  Constants constants;
  std::mutex mutex;
  std::vector<std::unique_ptr<BoundParser>> idle;
  bool is_constant = false;
};

Expression::Expression() = default;

Expression::Expression(double value) : constant_(value) {}

Expression::Expression(std::function<double(const Vec3& x)> function) : function_(std::move(function)) {}

Expression::Expression(const std::string& text, const SourceLocation& location, const Constants& constants,
                       const std::optional<Unit>& wanted) {
  check_text(text, location);
  const TextWithoutUnits plain = without_units(text, location, constants);
  auto compiled = std::make_unique<Compiled>(plain, text, location, constants);
  if (compiled->is_constant) constant_ = compiled->evaluate(Vec3::Zero());
  const bool zero = compiled->is_constant && constant_ == 0;
  if (plain.has_units)
    if (const auto found = dimension_of(plain, text, location, constants); found && wanted && !zero)
      value_in(*wanted, Quantity(0, *found, true), location, in_quotes(text), "an expression");
  if (!compiled->is_constant) compiled_ = std::move(compiled);
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

Expression::Expression(const Expression& other)
    : constant_(other.constant_),
      function_(other.function_),
      compiled_(other.compiled_ ? std::make_unique<Compiled>(*other.compiled_) : nullptr) {}

Expression& Expression::operator=(const Expression& other) {
  if (this != &other) *this = Expression(other);
  return *this;
}

double Expression::operator()(const Vec3& x) const {
  if (function_) return function_(x);
  return compiled_ ? compiled_->evaluate(x) : constant_;
}

bool Expression::is_zero() const { return is_constant() && constant_ == 0; }

bool Expression::is_constant() const { return compiled_ == nullptr && !function_; }

std::vector<Expression> Expression::compared() const {
  std::vector<Expression> differences;
  if (!compiled_) return differences;
  for (const auto& [left, right] : find_comparisons(compiled_->plain.text)) {
    Expression difference("(" + left + ")-(" + right + ")", compiled_->location, compiled_->plain.constants);
    if (!difference.is_constant()) differences.push_back(std::move(difference));
  }
  return differences;
}

Quantity evaluate_constant(const std::string& text, const SourceLocation& location, const Constants& constants) {
  check_text(text, location);
  const TextWithoutUnits plain = without_units(text, location, constants);
  double value = 0;
  try {
    mu::Parser parser = make_parser(plain.constants);
    parser.SetExpr(plain.text);
    value = parser.Eval();
  } catch (const mu::ParserError& error) {
    fail(error, text, location, constants, false);
  }
  if (!std::isfinite(value))
    throw InputError(location, in_quotes(text),
                     "the value is not finite" + used_constants(text, constants) + " (division by zero?)",
                     "a finite number");
  Quantity quantity(value);
  if (plain.has_dimensions) {
    const std::optional<Dimension> found = dimension_of(plain, text, location, constants);
    if (value != 0) quantity.dimension = found;
    quantity.has_units = plain.has_units;
  }
  return quantity;
}

std::vector<std::string> identifiers(const std::string& text) {
  std::vector<std::string> names;
  const auto add = [&names](const std::string& name, bool is_called) {
    if (!is_called && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for_each_name(text, add, true);
  return names;
}

std::string used_constants(const std::string& text, const Constants& constants) {
  std::string result;
  for (const std::string& name : identifiers(text))
    if (const auto found = constants.find(name); found != constants.end())
      result += (result.empty() ? " with " : ", ") + name + " = " + format_number(found->second);
  return result;
}

bool is_free_name(const std::string& name) {
  if (name.empty() || !starts_name(name[0]) || !std::all_of(name.begin(), name.end(), continues_name)) return false;
  if (name == "pi" || name == contact_force_name ||
      std::find(std::begin(axis_names), std::end(axis_names), name) != std::end(axis_names))
    return false;
  const mu::Parser parser;
  return parser.GetFunDef().count(name) == 0 && parser.GetConst().count(name) == 0;
}

}  // namespace cgcontact
