/// Materials by name: those of the library are those of docs/materials.md, and a scene can add its own.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/scene_file/read_scene.hpp"
#include "core/scene_file/sections/material_library.hpp"

namespace cgcontact::test_materials {
namespace {

Material material_of(const std::vector<std::string>& overrides) {
  return parse_scene(R"(
[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [1, 2, 3]}}
material = "steel"
cell_size = 0.3

[[support]]
face = "block.z-"
symmetry = true

[[material]]
name = "foam"
E = "2 MPa"
nu = 0.1
density = "40 kg/m^3"
expansion = "50e-6 1/K"
yield = "0.1 MPa"
)",
                     "materials.toml", overrides)
      .bodies[0]
      .material;
}

std::string message_of(const std::vector<std::string>& overrides) {
  try {
    material_of(overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_contains(const std::string& text, const std::vector<std::string>& wanted) {
  for (const std::string& words : wanted) EXPECT_NE(text.find(words), std::string::npos) << words << "\n  in: " << text;
}

/// The number at the start of a cell of the table, times a factor; none for a dash.
std::optional<double> value(const std::string& cell, double factor) {
  std::istringstream stream(cell);
  double number = 0;
  if (!(stream >> number)) return std::nullopt;
  return number * factor;
}

void expect_same(const std::optional<double>& a, const std::optional<double>& b, const std::string& name) {
  ASSERT_EQ(a.has_value(), b.has_value()) << name;
  EXPECT_NEAR(a.value_or(0), b.value_or(0), 1e-12 * std::abs(b.value_or(0))) << name;  // 12e-6 and 12 times 1e-6
}

// Rows of the table: name, GPa, -, kg/m^3, 1e-6/K, MPa, source.
TEST(Materials, of_the_library_are_those_of_the_document) {
  std::ifstream file(std::filesystem::path(CGCONTACT_SOURCE_DIR) / "docs" / "materials.md");
  std::size_t found = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(cell);
    ASSERT_GE(cells.size(), 7u) << line;
    const std::string name = cells[0].substr(2, cells[0].rfind('`') - 2);
    ASSERT_LT(found, material_library().size());
    const NamedMaterial& entry = material_library()[found++];
    EXPECT_EQ(entry.name, name);
    expect_same(entry.material.youngs_modulus, value(cells[1], 1e9), name);
    expect_same(entry.material.poisson_ratio, value(cells[2], 1), name);
    expect_same(entry.material.density, value(cells[3], 1), name);
    expect_same(entry.material.expansion, value(cells[4], 1e-6), name);
    expect_same(entry.material.yield_stress, value(cells[5], 1e6), name);
    EXPECT_GT(cells[6].size(), 10u) << name << ": a source";
  }
  EXPECT_EQ(found, material_library().size());
}

TEST(Materials, are_known_by_name) {
  const Material steel = material_of({});
  EXPECT_EQ(steel.youngs_modulus, 210e9);
  EXPECT_EQ(steel.poisson_ratio, 0.3);
  EXPECT_EQ(steel.density, 7850);
  EXPECT_EQ(steel.expansion, 12e-6);
  EXPECT_FALSE(steel.yield_stress);
  EXPECT_EQ(material_of({"body.block.material=S355"}).yield_stress, 355e6);
  const Material foam = material_of({"body.block.material=foam"});
  EXPECT_EQ(foam.youngs_modulus, 2e6);
  EXPECT_EQ(foam.density, 40);
  EXPECT_EQ(foam.expansion, 50e-6);
  EXPECT_EQ(foam.yield_stress, 1e5);
  EXPECT_EQ(material_of({"body.block.material=foam", "material.foam.E=3 MPa"}).youngs_modulus, 3e6);
}

TEST(Materials, mistakes_name_what_there_is) {
  expect_contains(message_of({"body.block.material=stele"}),
                  {"body[0].material = \"stele\": there is no such material (did you mean \"steel\"?)",
                   "(allowed: steel, S235,", "foam", "{E = .., nu = ..}"});
  expect_contains(message_of({"material.foam.name=steel"}),
                  {"material[0].name = \"steel\": is the name of another material"});
  expect_contains(message_of({"material.foam.rho=3"}), {"unknown key \"rho\"", "material.density"});
  expect_contains(message_of({"material.foam.E=0"}), {"material[0].E = 0: out of range (allowed: > 0 Pa)"});
  expect_contains(message_of({"material.foam.expansion=3 mm"}), {"is a length, not a coefficient of expansion", "1/K"});
  expect_contains(message_of({"body.block.material=3"}), {"is a number, not a table"});
}

}  // namespace
}  // namespace cgcontact::test_materials
