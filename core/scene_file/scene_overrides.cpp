#include "core/scene_file/scene_overrides.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/files/text.hpp"
#include "core/scene_file/sections/scene_reader.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t max_key_parts = 20;

/// One --set option.
struct Override {
  std::string source;              ///< "--set key=value", shown in error messages
  std::vector<std::string> steps;  ///< of the dotted key
  std::string value;               ///< TOML or bare text

  [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& allowed) const {
    throw InputError(SourceLocation{source, 0, key}, "", problem, allowed);
  }
};

/// Returns whether every bracket is in a "[...]" that ends the key or is followed by a dot or another one.
bool has_whole_brackets(const std::string& key) {
  for (std::size_t k = key.find_first_of("[]"); k != std::string::npos; k = key.find_first_of("[]", k + 1)) {
    const std::size_t end = key.find_first_of("[].", k + 1);
    if (key[k] == ']' || end == std::string::npos || key[end] != ']') return false;
    if (end + 1 < key.size() && key[end + 1] != '.' && key[end + 1] != '[') return false;
    k = end;
  }
  return true;
}

/// Splits "a.b[2].c=value" at the first "=" and the key at dots and brackets.
Override parse_override(const std::string& text) {
  Override result;
  result.source = override_prefix + text;
  const std::size_t equal = text.find('=');
  if (equal == std::string::npos) result.fail("", "has no value", "key=value, for example body.lower.cell_size=1e-3");
  result.value = trimmed(text.substr(equal + 1));
  std::string key = trimmed(text.substr(0, equal));
  if (!has_whole_brackets(key)) result.fail("", "the key has a bracket too many or too few", "body[0].cell_size=1e-3");
  std::replace(key.begin(), key.end(), '[', '.');
  key.erase(std::remove(key.begin(), key.end(), ']'), key.end());
  std::size_t begin = 0;
  while (begin <= key.size()) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    result.steps.push_back(trimmed(key.substr(begin, end - begin)));
    if (result.steps.back().empty()) result.fail("", "the key has an empty part", "dotted.key=value");
    begin = end + 1;
  }
  if (result.steps.size() > max_key_parts) result.fail("", "the key has too many parts", "keys of a scene");
  return result;
}

/// The value as a table {value = ...}, marked with the override's text as its source; text that is no TOML is a string.
toml::table parse_value(const std::string& value, const std::string& source) {
  const std::string_view path = source;
  if (!value.empty() && value.find('\n') == std::string::npos) {
    try {
      return toml::parse(std::string_view("value = " + value), path);
    } catch (const toml::parse_error&) {
      // Bare text: becomes a string below.
    }
  }
  std::string escaped;
  for (const char c : value) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  try {
    return toml::parse(std::string_view("value = \"" + escaped + "\""), path);
  } catch (const toml::parse_error& error) {
    throw InputError(SourceLocation{source, 0, ""}, "", std::string(error.description()));
  }
}

void insert(toml::table& table, const std::string& key, toml::table&& holder) {
  holder.get("value")->visit([&](auto& value) { table.insert_or_assign(key, std::move(value)); });
}

void replace(toml::array& array, std::size_t index, toml::table&& holder) {
  holder.get("value")->visit([&](auto& value) { array.replace(array.begin() + index, std::move(value)); });
}

std::optional<std::string> name_of(const toml::node& node) {
  const toml::table* table = node.as_table();
  const toml::node* name = table ? table->get("name") : nullptr;
  return name ? name->value<std::string>() : std::nullopt;
}

/// Index of the array's element with that index or name; fails with the names there are.
std::size_t element_index(const toml::array& array, const std::string& step, const std::string& key,
                          const Override& change) {
  if (std::all_of(step.begin(), step.end(), [](unsigned char c) { return std::isdigit(c); }) && step.size() < 9) {
    const std::size_t index = std::stoul(step);
    if (index < array.size()) return index;
  }
  std::vector<std::string> names;
  for (std::size_t k = 0; k < array.size(); ++k) {
    const auto name = name_of(array[k]);
    if (name == step) return k;
    if (name) names.push_back(*name);
  }
  std::string allowed = array.empty() ? "there are no elements" : "0 to " + std::to_string(array.size() - 1);
  if (!names.empty()) allowed += ", " + join(names);
  change.fail(key, "there is no element \"" + step + "\"" + did_you_mean(step, names), allowed);
}

/// One step down the key; a table that does not exist yet is made (the reader says if it knows no such key).
toml::node& descend(toml::node& node, const std::string& step, const std::string& key, const Override& change) {
  if (toml::array* array = node.as_array()) return (*array)[element_index(*array, step, key, change)];
  toml::table* table = node.as_table();
  if (!table) change.fail(key, "is a single value, it has no part \"" + step + "\"", "the key of a value");
  if (!table->contains(step)) insert(*table, step, parse_value("{}", change.source));
  return *table->get(step);
}

/// Makes "parameters.n=32" out of "n=32" and refuses a short key that is neither a parameter nor in the file.
void expand_short_key(const toml::table& document, Override& change) {
  const std::string name = change.steps[0];
  if (change.steps.size() > 1 || document.contains(name) || name == "title") return;
  std::vector<std::string> names;
  if (const toml::table* parameters = document["parameters"].as_table())
    for (const auto& entry : *parameters) names.emplace_back(entry.first.str());
  const bool is_parameter = std::find(names.begin(), names.end(), name) != names.end();
  if (!is_parameter && std::find(scene_keys().begin(), scene_keys().end(), name) != scene_keys().end()) return;
  if (!is_parameter)
    change.fail(name, "there is no such parameter" + did_you_mean(name, names),
                (names.empty() ? "" : join(names) + ", or ") + std::string("a dotted key such as body.NAME.cell_size"));
  change.steps.insert(change.steps.begin(), "parameters");
}

void apply_override(toml::table& document, Override change) {
  expand_short_key(document, change);
  toml::node* node = &document;
  std::string key;
  for (std::size_t k = 0; k + 1 < change.steps.size(); ++k) {
    node = &descend(*node, change.steps[k], key, change);
    key += (key.empty() ? "" : ".") + change.steps[k];
  }
  const std::string& last = change.steps.back();
  toml::table holder = parse_value(change.value, change.source);
  if (toml::array* array = node->as_array())
    replace(*array, element_index(*array, last, key, change), std::move(holder));
  else if (toml::table* table = node->as_table())
    insert(*table, last, std::move(holder));
  else
    change.fail(key, "is a single value, it has no part \"" + last + "\"", "the key of a value");
}

}  // namespace

void apply_overrides(toml::table& document, const std::vector<std::string>& overrides) {
  for (const std::string& text : overrides) apply_override(document, parse_override(text));
}

}  // namespace cgcontact
