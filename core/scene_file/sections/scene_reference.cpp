/// Section [reference] of the scene file. What it says may depend on the contact force, which is known after the solve.
#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include "core/scene_file/sections/scene_reader.hpp"

namespace cgcontact {

namespace {

/// Path of an existing file, given relative to the scene file.
std::string existing_file(const TomlCursor& node) {
  const std::filesystem::path given = node.string("a file, relative to the scene file");
  const std::filesystem::path folder = std::filesystem::path(node.text().file).parent_path();
  const std::filesystem::path path = given.is_absolute() ? given : folder / given;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    node.fail("there is no such file", "a file, relative to the scene file (here " + path.string() + ")");
  return path.string();
}

std::vector<std::array<Expression, 6>> read_stress(const TomlCursor& node, const std::vector<std::string>& body_names) {
  node.expect_keys(body_names);
  const std::string allowed = "[xx, yy, zz, xy, yz, zx] of numbers or expressions, Pa";
  std::vector<std::array<Expression, 6>> result;
  for (const std::string& name : body_names) {
    const TomlCursor list = node.at(name, allowed);
    const std::vector<TomlCursor> components = list.elements(allowed);
    if (components.size() != 6) list.fail("has " + std::to_string(components.size()) + " components, not 6", allowed);
    std::array<Expression, 6> stress;
    for (std::size_t k = 0; k < 6; ++k) stress[k] = components[k].expression("Pa");
    result.push_back(stress);
  }
  return result;
}

std::vector<std::pair<std::string, Expression>> read_zones(const TomlCursor& node) {
  if (!node.is_table()) node.expect_keys({"name = \"expression\""});
  std::vector<std::pair<std::string, Expression>> zones;
  for (const auto& [name, entry] : node.entries()) {
    const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) || c >= 0x80 || std::strchr("_- .", c);
    });
    if (name.empty() || !plain || name == "whole")
      entry.fail(name == "whole" ? "\"whole\" is the name of the whole face" : "is no name of a zone",
                 "another name of letters, digits, _ - . and blanks");
    zones.emplace_back(name, entry.expression(""));
  }
  return zones;
}

/// Everything that [reference] may use: the scene's parameters, the contact force, [reference.parameters].
SceneText reference_text(const TomlCursor& node, std::optional<double> contact_force) {
  SceneText text = node.text();
  if (contact_force) text.parameters[contact_force_name] = Quantity(*contact_force, unit_named("N").dimension, false);
  const auto table = node.find("parameters");
  if (!table) return text;
  for (const auto& [name, entry] : table->entries())
    if (node.text().parameters.count(name)) entry.fail("\"" + name + "\" is one of [parameters]", "another name");
  const SceneText known = text;
  text.parameters = read_parameters(TomlCursor(table->node(), table->key(), known));
  return text;
}

/// Returns whether any text in the node uses the name in an expression.
bool mentions(const toml::node& node, const std::string& name) {
  if (const toml::table* table = node.as_table())
    return std::any_of(table->begin(), table->end(), [&](const auto& entry) { return mentions(entry.second, name); });
  if (const toml::array* array = node.as_array())
    return std::any_of(array->begin(), array->end(), [&](const toml::node& child) { return mentions(child, name); });
  if (!node.is_string()) return false;
  const std::vector<std::string> names = identifiers(*node.value<std::string>());
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

ReferenceSpec read_reference(const TomlCursor& section, const std::vector<std::string>& body_names,
                             std::optional<double> contact_force) {
  section.expect_keys(
      {"parameters", "pressure", "pressure_file", "stress_file", "coordinate", "force", "stress", "zones"});
  const SceneText text = reference_text(section, contact_force);
  const TomlCursor node(section.node(), section.key(), text);
  ReferenceSpec reference;
  reference.location = node.location();
  if (const auto value = node.find("pressure")) reference.pressure = value->expression("Pa");
  if (const auto value = node.find("pressure_file")) {
    if (reference.pressure) value->fail("the pressure is given already by an expression", "pressure or pressure_file");
    reference.pressure_file = existing_file(*value);
  }
  if (const auto value = node.find("stress_file")) reference.stress_file = existing_file(*value);
  if (const auto value = node.find("coordinate"))
    reference.coordinate = static_cast<Coordinate>(value->one_of(coordinate_names()));
  // Comparing the force with itself would say nothing.
  if (const auto value = section.find("force")) reference.force = value->number(Range::any("N"));
  if (const auto value = node.find("stress")) reference.stress_of_body = read_stress(*value, body_names);
  if (const auto value = node.find("zones")) reference.zones = read_zones(*value);
  return reference;
}

bool uses_contact_force(const TomlCursor& section) { return mentions(section.node(), contact_force_name); }

}  // namespace cgcontact
