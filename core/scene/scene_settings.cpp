/// Sections of the scene file that are plain settings: steps, solver, recovery, output.
#include <fmt/format.h>

#include "core/scene/scene_reader.hpp"

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

Range from_to(double min, double max, const std::string& text) {
  Range range;
  range.min = min;
  range.max = max;
  range.text = text;
  return range;
}

/// Relative residuals that double precision can reach.
Range tolerance() {
  Range range = from_to(1e-15, 1, ">= 1e-15 and < 1");
  range.max_allowed = false;
  return range;
}

/// One degree for all patches, or a table by class of patch.
RecoveryDegree read_degree(const TomlCursor& node) {
  RecoveryDegree degree;
  if (!node.is_table()) {
    if (node.is_array() || node.node().is_boolean())
      node.fail("is neither a number nor a table", "1, 2 or {interior = 1, boundary = 2, contact = 2}");
    degree.interior = degree.boundary = degree.contact = node.integer(1, 2);
    return degree;
  }
  node.expect_keys({"interior", "boundary", "contact"});
  if (const auto value = node.find("interior")) degree.interior = value->integer(1, 2);
  if (const auto value = node.find("boundary")) degree.boundary = value->integer(1, 2);
  if (const auto value = node.find("contact")) degree.contact = value->integer(0, 2);
  return degree;
}

std::pair<Vec3, Vec3> read_path(const TomlCursor& node) {
  node.expect_keys({"from", "to"});
  const Vec3 from = node.at("from", "[x, y, z], m").vector("m"), to = node.at("to", "[x, y, z], m").vector("m");
  if (!((to - from).stableNorm() > 0)) node.fail("has no length", "from different from to");
  return {from, to};
}

/// Factors of one kind in all steps; the last one is 1.
std::vector<double> read_factors(const TomlCursor& node) {
  constexpr std::size_t most_steps = 1000;
  Range range = Range::not_negative();
  range.text = ">= 0, part of what the scene says";
  std::vector<double> factors;
  for (const TomlCursor& element : node.elements("factors, one for each step"))
    factors.push_back(element.number(range));
  if (factors.empty() || factors.size() > most_steps)
    node.fail(fmt::format("has {} factors", factors.size()), fmt::format("1 to {}", most_steps));
  if (factors.back() != 1) node.fail("does not end with 1", "a last step that is the scene itself: [.., 1]");
  return factors;
}

}  // namespace

std::vector<StepSpec> read_steps(const TomlCursor& node) {
  node.expect_keys({"factors", "loads", "displacements", "interference"});
  const std::pair<const char*, double StepSpec::*> kinds[] = {{"loads", &StepSpec::loads},
                                                              {"displacements", &StepSpec::displacements},
                                                              {"interference", &StepSpec::interference}};
  const auto all = node.find("factors");
  std::vector<StepSpec> steps;
  const std::string allowed = "factors = [..] of everything, or some of loads, displacements, interference = [..]";
  for (const auto& [key, member] : kinds) {
    const auto own = node.find(key);
    if (own && all) own->fail("stands beside factors", allowed);
    if (!own && !all) continue;
    const std::vector<double> factors = read_factors(own ? *own : *all);
    if (!steps.empty() && steps.size() != factors.size())
      own->fail(fmt::format("has {} factors, the list before it {}", factors.size(), steps.size()),
                "one factor for each step");
    steps.resize(factors.size());
    for (std::size_t k = 0; k < steps.size(); ++k) steps[k].*member = factors[k];
  }
  if (steps.empty()) node.fail("says no factors", allowed);
  return steps;
}

SolverSpec read_solver(const TomlCursor& node) {
  node.expect_keys({"preconditioner", "tolerance", "max_outer_iterations", "linear_tolerance", "max_linear_iterations",
                    "kappa", "ghost_penalty"});
  SolverSpec solver;
  if (const auto value = node.find("preconditioner")) solver.preconditioner = value->one_of({"multigrid", "muelu"});
  if (const auto value = node.find("tolerance")) solver.tolerance = value->number(tolerance());
  if (const auto value = node.find("max_outer_iterations")) solver.max_outer_iterations = value->integer(1, 1000);
  if (const auto value = node.find("linear_tolerance")) solver.linear_tolerance = value->number(tolerance());
  if (const auto value = node.find("max_linear_iterations")) solver.max_linear_iterations = value->integer(1, 1000000);
  if (const auto value = node.find("kappa")) solver.kappa = value->number(from_to(1e-3, 1e6, "1e-3 to 1e6"));
  if (const auto value = node.find("ghost_penalty")) solver.ghost_penalty = value->number(from_to(0, 1e3, "0 to 1000"));
  return solver;
}

/// 0, 1, 3 or 6.
int read_points_per_face(const TomlCursor& node) {
  const int points = static_cast<int>(node.integer(0, 6));
  if (points != 0 && points != 1 && points != 3 && points != 6)
    node.fail("out of range", "0 (by the degree), 1, 3 or 6");
  return points;
}

RecoverySpec read_recovery(const TomlCursor& node) {
  node.expect_keys({"spr_c", "rank_tolerance", "auxiliary_depth", "contact_edge", "degree", "rings", "points_per_face",
                    "patch_volume", "inverse_variance"});
  RecoverySpec recovery;
  Range depth = Range::positive();
  depth.max = 4;
  depth.text = "> 0 and <= 4 cells of the other body";
  Range volume = Range::positive();
  volume.max = 8;
  volume.text = "> 0 and <= 8 cells";
  if (const auto value = node.find("spr_c")) recovery.spr_c = value->boolean();
  if (const auto value = node.find("rank_tolerance")) recovery.rank_tolerance = value->number(fraction());
  if (const auto value = node.find("contact_edge")) recovery.contact_edge = value->boolean();
  if (const auto value = node.find("auxiliary_depth")) recovery.auxiliary_depth = value->number(depth);
  if (const auto value = node.find("inverse_variance")) recovery.inverse_variance = value->boolean();
  if (const auto value = node.find("points_per_face")) recovery.points_per_face = read_points_per_face(*value);
  if (const auto value = node.find("patch_volume")) recovery.patch_volume = value->number(volume);
  if (const auto value = node.find("rings")) recovery.rings = value->integer(0, 4);
  if (const auto value = node.find("degree")) recovery.degree = read_degree(*value);
  return recovery;
}

OutputSpec read_output(const TomlCursor& node) {
  node.expect_keys({"directory", "vtk", "csv", "plots", "report", "path"});
  OutputSpec output;
  if (const auto value = node.find("directory")) output.directory = value->string("a directory");
  if (const auto value = node.find("vtk")) output.vtk = value->boolean();
  if (const auto value = node.find("csv")) output.csv = value->boolean();
  if (const auto value = node.find("plots")) output.plots = value->boolean();
  if (const auto value = node.find("report")) output.report = value->boolean();
  if (const auto value = node.find("path")) output.path = read_path(*value);
  return output;
}

}  // namespace cgcontact
