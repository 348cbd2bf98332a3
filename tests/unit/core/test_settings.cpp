// Settings: one list each for reading, checking and printing; the documented defaults are those.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "core/base/errors/errors.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test_settings {
namespace {

/// One line of print().
struct Line {
  bool is_comment = false;
  std::string value, about;
};

std::map<std::string, Line> printed(const std::string& text) {
  std::map<std::string, Line> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_comment = line.rfind("# ", 0) == 0;
    const std::size_t begin = is_comment ? 2 : 0, equal = line.find(" = "), about = line.find("  # ");
    if (equal < about)
      found[line.substr(begin, equal - begin)] = {is_comment, line.substr(equal + 3, about - equal - 3),
                                                  line.substr(about + 4)};
  }
  return found;
}

/// Key -> value of those that a scene can set.
std::map<std::string, std::string> values_of_scene(const std::vector<Setting>& settings, const std::string& text) {
  std::map<std::string, std::string> values;
  for (const Setting& setting : settings)
    if (setting.of_scene) values[setting.key] = printed(text).at(setting.key).value;
  return values;
}

/// Keys "table.entry" as one inline table: degree = {interior = 1, boundary = 1, contact = 0}.
std::map<std::string, std::string> with_tables(const std::vector<Setting>& settings,
                                               std::map<std::string, std::string> values) {
  std::map<std::string, std::string> tables;
  for (const Setting& setting : settings) {
    const std::size_t dot = setting.key.find('.');
    if (dot == std::string::npos || !setting.of_scene) continue;
    std::string& table = tables[setting.key.substr(0, dot)];
    table += (table.empty() ? "{" : ", ") + setting.key.substr(dot + 1) + " = " + values.at(setting.key);
    values.erase(setting.key);
  }
  for (const auto& [key, table] : tables) values[key] = table + "}";
  return values;
}

std::string without(std::string text, char c) {
  text.erase(std::remove(text.begin(), text.end(), c), text.end());
  return text;
}

/// Numbers are compared as numbers.
bool same_value(const std::string& documented, const std::string& ours) {
  char* end = nullptr;
  const double number = std::strtod(documented.c_str(), &end);
  return *end == '\0' && !documented.empty() ? number == std::strtod(ours.c_str(), nullptr) : documented == ours;
}

/// Key -> default in the table of a section of docs/scene.md.
std::map<std::string, std::string> documented(const std::string& section) {
  std::ifstream file(std::string(CGCONTACT_SOURCE_DIR) + "/docs/scene.md");
  std::map<std::string, std::string> defaults;
  bool here = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("##", 0) == 0) here = line == "## `[" + section + "]`";
    if (!here || line.rfind("| `", 0) != 0) continue;
    std::vector<std::string> columns;
    std::istringstream row(line.substr(2));
    for (std::string column; std::getline(row, column, '|');) {
      column = without(column, '`');
      column.erase(0, column.find_first_not_of(' '));
      column.erase(column.find_last_not_of(' ') + 1);
      columns.push_back(column);
    }
    if (columns.size() >= 3) defaults[columns[0]] = columns[2];
  }
  return defaults;
}

template <class Options>
void expect_documented(const std::string& section) {
  Options options;
  const auto ours = with_tables(options.settings(), values_of_scene(options.settings(), options.print()));
  auto theirs = documented(section);
  ASSERT_FALSE(theirs.empty());
  for (const auto& [key, value] : ours) {
    ASSERT_TRUE(theirs.count(key)) << section << "." << key << " is not in docs/scene.md";
    EXPECT_TRUE(same_value(theirs[key], value))
        << section << "." << key << ": documented " << theirs[key] << ", is " << value;
    theirs.erase(key);
  }
  // Other tables of the section have rows as well; they begin with a number or with what is no key.
  for (const auto& [key, value] : theirs) ADD_FAILURE() << section << "." << key << " is documented only";
}

TEST(Settings, DocumentedDefaultsAreThoseOfTheProgram) {
  expect_documented<SolverOptions>("solver");
  expect_documented<RecoveryOptions>("recovery");
  expect_documented<OutputOptions>("output");
}

TEST(Settings, PrintedSettingsMakeTheSameScene) {
  SolverOptions solver;
  solver.method = LinearMethod::flexible_gmres;
  solver.preconditioner = Preconditioner::muelu;
  solver.tolerance = 1.0 / 3e7;
  solver.max_outer_iterations = 7;
  RecoveryOptions recovery;
  recovery.spr_c = false;
  recovery.degree = {2, 1, 2};
  recovery.points_per_face = 3;
  const std::string text =
      "body = [{name = \"a\", shape = {name = \"s\", box = {min = [0, 0, 0], max = [1, 1, 1]}}, material = {E = 1, nu "
      "= 0}, "
      "cell_size = 0.5}]\nsupport = [{face = \"a.s.z-\", displacement = {x = 0, y = 0, z = 0}}]\n";
  const Scene scene = parse_scene(text + solver.print() + recovery.print(), "settings.toml");
  EXPECT_EQ(scene.solver.print(), solver.print());
  EXPECT_EQ(scene.recovery.print(), recovery.print());
  EXPECT_EQ(scene.solver.tolerance, solver.tolerance);
}

template <class Options, class Change>
std::string refusal(const Change& change) {
  Options options;
  options.check();
  change(options);
  try {
    options.check();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Settings, ValuesOutOfRangeAreNamedWithTheirRange) {
  EXPECT_EQ(refusal<SolverOptions>([](SolverOptions& o) { o.kappa = 0; }),
            "solver.kappa = 0: out of range (allowed: 1e-3 to 1e6)");
  EXPECT_EQ(refusal<SolverOptions>([](SolverOptions& o) { o.inner_fraction = 1; }),
            "solver.inner_fraction = 1: out of range (allowed: > 0 and < 1)");
  EXPECT_EQ(refusal<RecoveryOptions>([](RecoveryOptions& o) { o.points_per_face = 4; }),
            "recovery.points_per_face = 4: out of range (allowed: 0 (by the degree), 1, 3 or 6)");
  EXPECT_EQ(refusal<RecoveryOptions>([](RecoveryOptions& o) { o.degree.interior = 0; }),
            "recovery.degree.interior = 0: out of range (allowed: an integer from 1 to 2)");
  EXPECT_EQ(refusal<ContactOptions>([](ContactOptions& o) { o.reach_in_cells = std::nan(""); }),
            "contact.reach_in_cells = nan: out of range (allowed: > 0 cells)");
  EXPECT_EQ(refusal<GeometryOptions>([](GeometryOptions& o) { o.boundary_order = 0; }),
            "geometry.boundary_order = 0: out of range (allowed: an integer from 1 to 8)");
  EXPECT_EQ(refusal<RecoveryOptions>([](RecoveryOptions& o) { o.term_reach = -1; }),
            "recovery.term_reach = -1: out of range (allowed: >= 0 cells)");
  EXPECT_EQ(refusal<RecoveryOptions>([](RecoveryOptions& o) { o.balance.mean_exact = 0.07; }),
            "recovery.balance.mean_wrong = 0.06: out of range (allowed: > recovery.balance.mean_exact)");
  EXPECT_EQ(refusal<ResultOptions>([](ResultOptions& o) { o.lost_force = 2; }),
            "results.lost_force = 2: out of range (allowed: > 0 and < 1)");
  EXPECT_EQ(refusal<ResultOptions>([](ResultOptions& o) { o.min_cells_on_face = 0; }),
            "results.least_cells_on_face = 0: out of range (allowed: > 0 cells)");
  EXPECT_EQ(refusal<OutputOptions>([](OutputOptions& o) {
              o.path = {Vec3::Zero(), Vec3::Zero()};
            }),
            "output.path: has no length (allowed: from different from to)");
}

TEST(Settings, ConstantsOfTheMethodArePrintedAsComments) {
  const auto lines = printed(SolverOptions().print());
  EXPECT_EQ(lines.at("thin_kappa_factor").value, "3");
  EXPECT_TRUE(lines.at("thin_kappa_factor").is_comment);
  EXPECT_FALSE(lines.at("kappa").is_comment);
  EXPECT_EQ(printed(RecoveryOptions().print()).at("term_reach").value, "2");
}

TEST(Settings, ArePrintedWithDefaultRangeAndMeaning) {
  SolverOptions options;
  options.tolerance = 1e-3;
  const auto lines = printed(options.print());
  EXPECT_EQ(lines.at("tolerance").value, "0.001");
  EXPECT_EQ(lines.at("tolerance").about, "default 1e-06; >= 1e-15 and < 1; relative residual of the outer iteration");
  EXPECT_EQ(lines.at("nested").about, "default; true or false; large grids start from solutions on coarser ones");
  EXPECT_EQ(lines.at("preconditioner").about.rfind("default; multigrid, muelu; ", 0), 0u);
  const Line directory = printed(OutputOptions().print()).at("directory");  // of none there is nothing to take back
  EXPECT_TRUE(directory.is_comment);
  EXPECT_EQ(directory.value, "out/<name of the file>");
}

template <class Options>
void expect_meanings() {
  Options options;
  for (const Setting& setting : options.settings()) EXPECT_FALSE(setting.meaning.empty()) << setting.key;
}

TEST(Settings, AllHaveAMeaning) {
  expect_meanings<GeometryOptions>();
  expect_meanings<ContactOptions>();
  expect_meanings<SolverOptions>();
  expect_meanings<RecoveryOptions>();
  expect_meanings<ResultOptions>();
  expect_meanings<AccuracyOptions>();
  expect_meanings<OutputOptions>();
}

TEST(Settings, PrintedTargetsAreThoseOfTheScene) {
  AccuracyOptions accuracy;
  EXPECT_EQ(accuracy.print().rfind("# [accuracy]\n# pressure = none  # default; ", 0), 0u);
  EXPECT_TRUE(printed(accuracy.print()).at("max_time").is_comment);  // the section alone would be a mistake
  accuracy.force = 0.02;
  accuracy.stress_of_body = {{"lug", 0.1}};
  accuracy.named = {{NamedTarget::Kind::displacement, "beam.tip", 0.01}, {NamedTarget::Kind::pressure, "pair", 0.05}};
  const auto lines = printed(accuracy.print());
  EXPECT_EQ(lines.at("force").value, "0.02");
  EXPECT_EQ(lines.at("force").about.rfind("default none; > 0 and < 1; ", 0), 0u);
  EXPECT_EQ(lines.at("stress").value, "{\"lug\" = 0.1}");
  EXPECT_EQ(lines.at("displacement").value, "{\"beam.tip\" = 0.01}");
  EXPECT_FALSE(lines.at("max_time").is_comment);
  accuracy.force = 2;
  EXPECT_THROW(accuracy.check(), InputError);
}

}  // namespace
}  // namespace cgcontact::test_settings
