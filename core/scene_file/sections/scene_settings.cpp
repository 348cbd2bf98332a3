/// Sections of the scene file that are plain settings: steps, solver, recovery, output.
#include <fmt/format.h>

#include <algorithm>

#include "core/scene_file/sections/scene_reader.hpp"

namespace cgcontact {

namespace {

PathEnds read_path(const TomlCursor& node) {
  node.expect_keys({"from", "to"});
  const Vec3 from = node.at("from", "[x, y, z], m").vector("m"), to = node.at("to", "[x, y, z], m").vector("m");
  if (!((to - from).stableNorm() > 0)) node.fail("has no length", "from different from to");
  return {from, to};
}

/// Sets what the section says of a setting.
void read_setting(const TomlCursor& node, const Setting& setting) {
  struct Reader {
    const TomlCursor& node;
    const Setting& setting;
    void operator()(double* value) const { *value = node.number(setting.range); }
    void operator()(int* value) const {
      *value = node.integer(static_cast<int>(setting.range.min), static_cast<int>(setting.range.max));
      if (!setting.only.empty() && std::find(setting.only.begin(), setting.only.end(), *value) == setting.only.end())
        node.fail("out of range", setting.range.text);
    }
    void operator()(bool* value) const { *value = node.boolean(); }
    void operator()(std::string* value) const { *value = node.string("a " + setting.key); }
    void operator()(Target* value) const { *value = read_target(node); }
    void operator()(std::optional<PathEnds>* value) const { *value = read_path(node); }
    void operator()(const Choice& choice) const { choice.set_number(node.one_of(choice.names)); }
    void operator()(const OwnForm&) const {}  // left to the caller
  };
  std::visit(Reader{node, setting}, setting.value);
}

/// Reads the settings of a section, or of a table in it (`prefix`: "table."); tables in it are left to the caller.
void read_settings(const TomlCursor& section, const std::vector<Setting>& settings, const std::string& prefix = "") {
  std::vector<std::string> keys;
  std::vector<const Setting*> here;
  for (const Setting& setting : settings) {
    if (!setting.of_scene || setting.key.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string key = setting.key.substr(prefix.size()), name = key.substr(0, key.find('.'));
    if (std::find(keys.begin(), keys.end(), name) == keys.end()) keys.push_back(name);
    if (name == key) here.push_back(&setting);
  }
  MistakeList mistakes;
  mistakes.attempt([&] { section.expect_keys(keys); });
  for (const Setting* setting : here)
    if (const auto value = section.find(setting->key.substr(prefix.size())))
      mistakes.attempt([&] { read_setting(*value, *setting); });
  mistakes.throw_if_any(section.text().file);
}

/// One degree for all patches, or a table by class of patch.
void read_degree(const TomlCursor& node, RecoveryOptions& options) {
  if (node.is_table()) return read_settings(node, options.settings(), "degree.");
  if (node.is_array() || node.node().is_boolean())
    node.fail("is neither a number nor a table", "1, 2 or {interior = 1, boundary = 2, contact = 2}");
  options.degree.interior = options.degree.boundary = options.degree.contact = node.integer(1, 2);
}

constexpr std::size_t max_load_steps = 1000;

/// Factors of one kind in all steps; the last one is 1.
std::vector<double> read_factors(const TomlCursor& node) {
  Range range = Range::not_negative();
  range.text = ">= 0, part of what the scene says";
  std::vector<double> factors;
  for (const TomlCursor& element : node.elements("factors, one for each step"))
    factors.push_back(element.number(range));
  if (factors.empty() || factors.size() > max_load_steps)
    node.fail(fmt::format("has {} factors", factors.size()), fmt::format("1 to {}", max_load_steps));
  if (factors.back() != 1) node.fail("does not end with 1", "a last step that is the scene itself: [.., 1]");
  return factors;
}

}  // namespace

double read_target(const TomlCursor& node) {
  Range range = Range::fraction();
  range.text = "more than 0 and less than 1 (100 %), as 0.01 or \"1 %\"";
  if (!node.is_string()) return node.number(range);
  std::string text = node.string(range.text);
  const std::size_t sign = text.find_last_not_of(" \t");
  if (sign == std::string::npos || text[sign] != '%') return node.number(range);
  text.resize(sign);
  const Quantity per_cent = evaluate_constant(text, node.location(), node.text().parameters);
  const double value = value_in({}, per_cent, node.location(), node.value(), range.text) / 100;
  if (!range.contains(value)) node.fail("out of range", range.text);
  return value;
}

namespace {

/// Reads the target of the largest displacement, or name = target: a face, a probe or "largest".
std::vector<NamedTarget> read_displacement_targets(const TomlCursor& node) {
  std::vector<NamedTarget> targets;
  if (!node.is_table())
    targets.push_back({NamedTarget::Kind::displacement, "largest", read_target(node)});
  else
    for (const auto& [name, target] : node.entries())
      targets.push_back({NamedTarget::Kind::displacement, name, read_target(target)});
  if (targets.empty()) node.fail("names no place", "\"1 %\", or {\"body.face\" = \"1 %\", probe = \"1 %\", ...}");
  return targets;
}

/// body = target
std::vector<BodyTarget> read_body_targets(const TomlCursor& node) {
  std::vector<BodyTarget> targets;
  for (const auto& [body, target] : node.entries()) targets.push_back({body, read_target(target)});
  if (targets.empty()) node.fail("names no body", "\"1 %\", or {body = \"1 %\", ...}");
  return targets;
}

}  // namespace

AccuracyOptions read_accuracy(const TomlCursor& node) {
  AccuracyOptions options;
  read_settings(node, options.settings());
  if (const auto target = node.find("stress")) {
    if (target->is_table())
      options.stress_of_body = read_body_targets(*target);
    else
      options.stress = read_target(*target);
  }
  if (const auto target = node.find("displacement")) options.named = read_displacement_targets(*target);
  if (!options.any())
    node.fail("asks for nothing", "at least one of pressure, force, shear, stress, displacement = \"1 %\"");
  return options;
}

std::vector<double> read_own_steps(const TomlCursor& node, std::vector<StepSpec>& steps) {
  Range range;
  range.text = "a part of what stands there, of any sign";
  std::vector<double> factors;
  for (const TomlCursor& element : node.elements("factors, one for each step"))
    factors.push_back(element.number(range));
  if (factors.empty() || factors.size() > max_load_steps)
    node.fail(fmt::format("has {} factors", factors.size()), fmt::format("1 to {}", max_load_steps));
  if (!steps.empty() && steps.size() != factors.size())
    node.fail(fmt::format("has {} factors, the scene {} steps", factors.size(), steps.size()),
              "one factor for each step");
  for (std::size_t k = steps.size(); k < factors.size(); ++k) steps.emplace_back().number = k;
  return factors;
}

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
    for (std::size_t k = 0; k < steps.size(); ++k) {
      steps[k].number = k;
      steps[k].*member = factors[k];
    }
  }
  if (steps.empty()) node.fail("says no factors", allowed);
  return steps;
}

SolverOptions read_solver(const TomlCursor& node) {
  SolverOptions options;
  read_settings(node, options.settings());
  return options;
}

RecoveryOptions read_recovery(const TomlCursor& node) {
  RecoveryOptions options;
  read_settings(node, options.settings());
  if (const auto degree = node.find("degree")) read_degree(*degree, options);
  return options;
}

OutputOptions read_output(const TomlCursor& node) {
  OutputOptions options;
  read_settings(node, options.settings());
  return options;
}

}  // namespace cgcontact
