#include "core/scene_file/sections/scene_materials.hpp"

#include <algorithm>
#include <limits>

#include "core/base/errors/mistakes.hpp"
#include "core/base/errors/suggest.hpp"

namespace cgcontact {

namespace {

const std::vector<std::string> value_keys{"E", "nu", "density", "expansion", "yield"};

/// `keys`: all that the table may have.
Material read_values(const TomlCursor& node, const std::vector<std::string>& keys) {
  Range poisson;
  poisson.min = -1;
  poisson.max = 0.5;
  poisson.min_allowed = poisson.max_allowed = false;
  poisson.text = "-1 < nu < 0.5; at 0.5 the material is incompressible and its bulk modulus E/(3(1-2nu)) infinite";
  Range modulus;  // beyond it forces overflow
  modulus.min = 1e-9;
  modulus.max = 1e21;
  modulus.text = "1e-9 to 1e21 Pa";
  modulus.unit = "Pa";
  Material material;
  MistakeList mistakes;
  const bool known_keys = mistakes.attempt([&] { node.expect_keys(keys); });
  const auto read = [&](const char* key, const auto& task) {
    if (const auto value = node.find(key)) mistakes.attempt([&] { task(*value); });
  };
  read("E", [&](const TomlCursor& value) {
    value.number(Range::positive("Pa"));
    material.youngs_modulus = value.number(modulus);
    material.modulus_has_units = value.quantity().has_units;
  });
  read("nu", [&](const TomlCursor& value) { material.poisson_ratio = value.number(poisson); });
  read("density", [&](const TomlCursor& value) { material.density = value.number(Range::positive("kg/m^3")); });
  read("expansion", [&](const TomlCursor& value) { material.expansion = value.number(Range::any("1/K")); });
  read("yield", [&](const TomlCursor& value) { material.yield_stress = value.number(Range::positive("Pa")); });
  if (known_keys) {  // else what seems to be missing may be the key that is not known
    mistakes.attempt([&] { node.at("E", "> 0 Pa"); });
    mistakes.attempt([&] { node.at("nu", "-1 < nu < 0.5"); });
  }
  mistakes.throw_if_any(node.text().file);
  return material;
}

std::vector<std::string> names_of(const std::vector<NamedMaterial>& materials) {
  std::vector<std::string> names;
  for (const NamedMaterial& entry : materials) names.push_back(entry.name);
  return names;
}

}  // namespace

SceneMaterials::SceneMaterials(const TomlCursor& root) : materials_(material_library()) {
  const auto list = root.find("material");
  if (!list) return;
  for (const TomlCursor& node : list->elements("[[material]] sections")) {
    std::vector<std::string> keys = value_keys;
    keys.insert(keys.begin(), "name");
    const TomlCursor name_node = node.at("name", "a name");
    const std::string name = read_name(name_node);
    const std::vector<std::string> known = names_of(materials_);
    if (std::find(known.begin(), known.end(), name) != known.end())
      name_node.fail("is the name of another material, of the scene or of the library", "none of " + join(known));
    materials_.push_back({name, read_values(node, keys)});
  }
}

Material SceneMaterials::read_rigid(const std::optional<TomlCursor>& node) const {
  Material material;
  material.youngs_modulus = std::numeric_limits<double>::infinity();
  if (!node) return material;
  if (node->is_string()) {
    material.density = read(*node).density;
    return material;
  }
  for (const char* key : {"E", "nu", "expansion", "yield"})
    if (const auto value = node->find(key))
      value->fail("a rigid body has neither strain nor stress", "{density = ..}, or without rigid = true");
  node->expect_keys({"density"});
  material.density = node->at("density", "> 0 kg/m^3").number(Range::positive("kg/m^3"));
  return material;
}

Material SceneMaterials::read(const TomlCursor& node) const {
  if (!node.is_string()) return read_values(node, value_keys);
  const std::string name = node.string("the name of a material");
  for (const NamedMaterial& entry : materials_)
    if (entry.name == name) return entry.material;
  const std::vector<std::string> known = names_of(materials_);
  node.fail("there is no such material" + did_you_mean(name, known),
            join(known) + ", one of [[material]], or {E = .., nu = ..}");
}

}  // namespace cgcontact
