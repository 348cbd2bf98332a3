/// Sections of the scene file that are plain settings: solver, recovery, output, reference.
#include <algorithm>
#include <filesystem>

#include "core/scene_reader.hpp"
#include "core/suggest.hpp"

namespace cgcontact {

namespace {

/// Numbers strictly between 0 and 1.
Range fraction() {
  Range range = Range::positive();
  range.max = 1;
  range.max_allowed = false;
  range.text = "> 0 and < 1";
  return range;
}

std::string one_of(const TomlCursor& node, const std::vector<std::string>& names) {
  const std::string name = node.string(join(names));
  if (std::find(names.begin(), names.end(), name) == names.end())
    node.fail("is not known" + did_you_mean(name, names), join(names));
  return name;
}

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

std::pair<Vec3, Vec3> read_path(const TomlCursor& node) {
  node.expect_keys({"from", "to"});
  const Vec3 from = node.at("from", "[x, y, z], m").vector("m"), to = node.at("to", "[x, y, z], m").vector("m");
  if (!((to - from).stableNorm() > 0)) node.fail("has no length", "from different from to");
  return {from, to};
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
    for (std::size_t k = 0; k < 6; ++k) stress[k] = components[k].expression();
    result.push_back(stress);
  }
  return result;
}

std::vector<std::pair<std::string, Expression>> read_zones(const TomlCursor& node) {
  if (!node.is_table()) node.expect_keys({"name = \"expression\""});
  std::vector<std::pair<std::string, Expression>> zones;
  for (const auto& [name, entry] : node.entries()) zones.emplace_back(name, entry.expression());
  return zones;
}

}  // namespace

SolverSpec read_solver(const TomlCursor& node) {
  node.expect_keys({"preconditioner", "tolerance", "max_outer_iterations", "linear_tolerance", "max_linear_iterations",
                    "kappa", "ghost_penalty"});
  SolverSpec solver;
  if (const auto value = node.find("preconditioner")) solver.preconditioner = one_of(*value, {"multigrid", "muelu"});
  if (const auto value = node.find("tolerance")) solver.tolerance = value->number(fraction());
  if (const auto value = node.find("max_outer_iterations")) solver.max_outer_iterations = value->integer(1, 1000);
  if (const auto value = node.find("linear_tolerance")) solver.linear_tolerance = value->number(fraction());
  if (const auto value = node.find("max_linear_iterations")) solver.max_linear_iterations = value->integer(1, 1000000);
  if (const auto value = node.find("kappa")) solver.kappa = value->number(Range::positive());
  if (const auto value = node.find("ghost_penalty")) solver.ghost_penalty = value->number(Range::not_negative());
  return solver;
}

RecoverySpec read_recovery(const TomlCursor& node) {
  node.expect_keys({"spr_c", "rank_tolerance", "auxiliary_depth"});
  RecoverySpec recovery;
  Range depth = Range::positive();
  depth.max = 4;
  depth.text = "> 0 and <= 4 cells of the other body";
  if (const auto value = node.find("spr_c")) recovery.spr_c = value->boolean();
  if (const auto value = node.find("rank_tolerance")) recovery.rank_tolerance = value->number(fraction());
  if (const auto value = node.find("auxiliary_depth")) recovery.auxiliary_depth = value->number(depth);
  return recovery;
}

OutputSpec read_output(const TomlCursor& node) {
  node.expect_keys({"directory", "vtk", "csv", "plots", "path"});
  OutputSpec output;
  if (const auto value = node.find("directory")) output.directory = value->string("a directory");
  if (const auto value = node.find("vtk")) output.vtk = value->boolean();
  if (const auto value = node.find("csv")) output.csv = value->boolean();
  if (const auto value = node.find("plots")) output.plots = value->boolean();
  if (const auto value = node.find("path")) output.path = read_path(*value);
  return output;
}

ReferenceSpec read_reference(const TomlCursor& node, const std::vector<std::string>& body_names) {
  node.expect_keys({"pressure", "pressure_file", "stress_file", "coordinate", "force", "stress", "zones"});
  ReferenceSpec reference;
  reference.place = node.place();
  if (const auto value = node.find("pressure")) reference.pressure = value->expression();
  if (const auto value = node.find("pressure_file")) {
    if (reference.pressure) value->fail("the pressure is given already by an expression", "pressure or pressure_file");
    reference.pressure_file = existing_file(*value);
  }
  if (const auto value = node.find("stress_file")) reference.stress_file = existing_file(*value);
  if (const auto value = node.find("coordinate")) reference.coordinate = one_of(*value, {"x", "y", "z"});
  if (const auto value = node.find("force")) reference.force = value->number(Range::any("N"));
  if (const auto value = node.find("stress")) reference.stress_of_body = read_stress(*value, body_names);
  if (const auto value = node.find("zones")) reference.zones = read_zones(*value);
  return reference;
}

}  // namespace cgcontact
