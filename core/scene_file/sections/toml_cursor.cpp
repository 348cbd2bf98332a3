#include "core/scene_file/sections/toml_cursor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "core/base/errors/mistakes.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/scene_file/sections/unknown_physics.hpp"

namespace cgcontact {

namespace {

/// The value in one line, numbers with as many digits as they need.
std::string as_toml(const toml::node& node) {
  std::string text;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table)
      text += (text.empty() ? "" : ", ") + std::string(key.str()) + " = " + as_toml(child);
    return "{" + text + "}";
  }
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& child : *array) text += (text.empty() ? "" : ", ") + as_toml(child);
    return "[" + text + "]";
  }
  if (node.is_string()) return '"' + *node.value<std::string>() + '"';
  if (node.is_floating_point()) return fmt::format("{}", *node.value<double>());
  std::ostringstream stream;
  node.visit([&stream](const auto& value) { stream << value; });
  return stream.str();
}

/// Integers beyond 2^53 are rounded to the nearest double, as in "1e16".
double number_of(const toml::node& node) {
  if (const toml::value<std::int64_t>* integer = node.as_integer()) return static_cast<double>(integer->get());
  return *node.value<double>();
}

}  // namespace

TomlCursor::TomlCursor(const toml::node& node, std::string key, const SceneText& text)
    : node_(&node), key_(std::move(key)), text_(&text) {}

SourceLocation TomlCursor::location() const {
  const toml::source_region& source = node_->source();
  SourceLocation location{text_->file, static_cast<int>(source.begin.line), key_};
  if (source.path && source.path->rfind(override_prefix, 0) == 0) {
    location.file = *source.path;
    location.line = 0;
  }
  return location;
}

std::string TomlCursor::value() const { return node_->is_array_of_tables() ? "[...]" : as_toml(*node_); }

void TomlCursor::fail(const std::string& problem, const std::string& allowed) const {
  throw InputError(location(), value(), problem, allowed);
}

std::string TomlCursor::type_name() const {
  if (node_->is_table()) return "a table";
  if (node_->is_array()) return "an array";
  if (node_->is_string()) return "a string";
  if (node_->is_boolean()) return "a boolean";
  if (node_->is_number()) return "a number";
  return "a date or time";
}

void TomlCursor::expect_keys(const std::vector<std::string>& keys) const {
  if (!is_table()) fail("is " + type_name() + ", not a table", "{" + join(keys) + "}");
  MistakeList mistakes;
  for (const auto& [key, entry] : entries()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    mistakes.attempt([&keys, &name = key, &unknown = entry] {
      const std::string physics = unknown_physics(name);
      unknown.fail("unknown key \"" + name + "\"" + (physics.empty() ? did_you_mean(name, keys) : ": " + physics),
                   join(keys));
    });
  }
  mistakes.throw_if_any(text_->file);
}

std::optional<TomlCursor> TomlCursor::find(const std::string& key) const {
  const toml::table* table = node_->as_table();
  const toml::node* child = table ? table->get(key) : nullptr;
  if (!child) return std::nullopt;
  return TomlCursor(*child, key_.empty() ? key : key_ + "." + key, *text_);
}

TomlCursor TomlCursor::at(const std::string& key, const std::string& allowed) const {
  if (auto found = find(key)) return *found;
  SourceLocation where = location();
  where.key = key_.empty() ? key : key_ + "." + key;
  throw InputError(where, "", "this key is required but missing", allowed);
}

std::vector<std::pair<std::string, TomlCursor>> TomlCursor::entries() const {
  std::vector<std::pair<std::string, TomlCursor>> result;
  if (!is_table()) return result;
  std::vector<std::pair<toml::source_position, std::string>> order;
  for (const auto& [key, child] : *node_->as_table())
    order.emplace_back(key.source().begin ? key.source().begin : child.source().begin, std::string(key.str()));
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [position, key] : order) result.emplace_back(key, *find(key));
  return result;
}

std::vector<TomlCursor> TomlCursor::elements(const std::string& what) const {
  if (!is_array()) fail("is " + type_name() + ", not an array", what);
  std::vector<TomlCursor> result;
  std::size_t k = 0;
  for (const toml::node& child : *node_->as_array())
    result.emplace_back(child, key_ + "[" + std::to_string(k++) + "]", *text_);
  return result;
}

std::string TomlCursor::string(const std::string& what) const {
  if (!is_string()) fail("is " + type_name() + ", not a string", what);
  std::string text = *node_->value<std::string>();
  if (text.empty()) fail("is empty", what);
  return text;
}

int TomlCursor::one_of(const std::vector<std::string>& names) const {
  const std::string name = string(join(names));
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) fail("is not known" + did_you_mean(name, names), join(names));
  return static_cast<int>(found - names.begin());
}

bool TomlCursor::boolean() const {
  if (!node_->is_boolean()) fail("is " + type_name() + ", not a boolean", "true or false");
  return *node_->value<bool>();
}

Quantity TomlCursor::quantity(const std::string& allowed) const {
  if (is_string()) return evaluate_constant(*node_->value<std::string>(), location(), text_->parameters);
  if (!node_->is_number()) fail("is " + type_name() + ", not a number", allowed);
  return number_of(*node_);
}

Quantity TomlCursor::quantity() const {
  const std::string allowed = Range::any().text;
  const Quantity value = quantity(allowed);
  if (!std::isfinite(value.value)) fail("not finite", allowed);
  return value;
}

std::string TomlCursor::value_with_definition() const {
  if (!is_string()) return value();
  const auto found = text_->definitions.find(*node_->value<std::string>());
  return found == text_->definitions.end() ? value() : value() + " = \"" + found->second + "\"";
}

double TomlCursor::number(const Range& range) const {
  const double number =
      value_in(unit_named(range.unit), quantity(range.text), location(), value_with_definition(), range.text);
  if (std::isfinite(number) && range.contains(number)) return number;
  std::string problem = std::isfinite(number) ? "out of range" : "not finite";
  if (is_string())
    problem += fmt::format(", its value is {}", number) + (range.unit.empty() ? "" : " ") + range.unit +
               used_constants(*node_->value<std::string>(), text_->parameters);
  fail(problem, range.text);
}

int TomlCursor::integer(int min, int max) const {
  const Range range = Range::integers(min, max);
  const double value = number(range);
  if (value != std::floor(value)) fail("is not an integer", range.text);
  return static_cast<int>(value);
}

Vec3 TomlCursor::vector(const std::string& unit) const {
  const std::string allowed = "[x, y, z]" + (unit.empty() ? "" : ", " + unit);
  const std::vector<TomlCursor> components = elements(allowed);
  if (components.size() != 3) {
    const bool commas = components.size() > 3 && components.size() <= 6;
    fail("has " + std::to_string(components.size()) + " components, not 3" +
             (commas ? " (decimal commas? 0.5 is written with a point)" : ""),
         allowed);
  }
  Vec3 result;
  for (int k = 0; k < 3; ++k) result[k] = components[k].number(Range::any(unit));
  return result;
}

Vec3 TomlCursor::direction() const {
  const Vec3 v = vector();
  const double length = v.stableNorm();
  if (!(length > 0)) fail("has length zero", "any vector but [0, 0, 0]");
  return v / length;
}

Expression TomlCursor::expression(const std::string& unit) const {
  if (is_string() && text_->definitions.count(*node_->value<std::string>()))
    return Expression(number(Range::any(unit)));
  if (is_string()) return Expression(*node_->value<std::string>(), location(), text_->parameters, unit_named(unit));
  if (!node_->is_number()) fail("is " + type_name() + ", not a number", "a number or an expression of x, y, z");
  return Expression(number(Range::any()));
}

Mat3 TomlCursor::rotation() const {
  const Vec3 axis = at("axis", "[x, y, z]").direction();
  const double angle = at("angle", "degrees").number(Range::any("degrees"));
  return Eigen::AngleAxisd(angle * radians_per_degree, axis).toRotationMatrix();
}

void check_unique(const TomlCursor& node, const std::string& name, std::set<std::string>& seen,
                  const std::string& what) {
  if (!seen.insert(name).second) node.fail("is the name of an earlier " + what, "unique names");
}

std::string read_name(const TomlCursor& node) {
  constexpr std::size_t longest = 100;  // files have names made of up to two of them: 255 bytes at most
  const std::string allowed =
      fmt::format("letters, digits, \"_\" and \"-\", not starting with a digit, at most {} characters", longest);
  const std::string name = node.string(allowed);
  if (name.size() > longest) node.fail(fmt::format("has {} characters", name.size()), allowed);
  const bool good =
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
  if (!good || std::isdigit(static_cast<unsigned char>(name[0])) || name[0] == '-') node.fail("is not a name", allowed);
  return name;
}

}  // namespace cgcontact
