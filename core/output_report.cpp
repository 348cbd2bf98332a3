#include "core/output_report.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"
#include "core/output_text.hpp"

namespace cgcontact {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Vec3& v) { return Json::array({v[0], v[1], v[2]}); }

/// An object also when it has no entries.
Json object() { return Json::object(); }

Json json_of(const PairFigures& pair) {
  Json json;
  json["name"] = pair.name;
  json["bodies"] = {pair.body_first, pair.body_second};
  json["force"] = {{pair.body_first, json_of(pair.force_on_first)}, {pair.body_second, json_of(pair.force_on_second)}};
  json["moment"] = {{pair.body_first, json_of(pair.moment_on_first)},
                    {pair.body_second, json_of(pair.moment_on_second)}};
  json["area"] = pair.area;
  json["max_pressure"] = pair.max_pressure;
  json["points"] = pair.points;
  json["active_points"] = pair.active_points;
  json["pressure_error_estimate"] = pair.pressure_error_estimate;
  json["force_error_estimate"] = pair.force_error_estimate;
  return json;
}

Json json_of(const StepFigures& step) {
  Json contact = Json::array();
  for (const PairFigures& pair : step.pairs)
    contact.push_back({{"name", pair.name},
                       {"force", json_of(pair.force_on_first)},
                       {"area", pair.area},
                       {"max_pressure", pair.max_pressure}});
  return {{"loads", step.step.loads},
          {"displacements", step.step.displacements},
          {"interference", step.step.interference},
          {"outer_iterations", step.outer_iterations},
          {"converged", step.converged},
          {"contact", contact}};
}

void add_errors(const Results& results, Json& json) {
  json["estimated_error"] = {{"absolute", results.estimated_error}, {"relative", results.estimated_error_relative}};
  if (results.has_effectivity) {
    json["exact_error"] = results.exact_error;
    json["effectivity"] = results.effectivity;
  }
  Json patches = object(), status = object();
  for (const auto& [kind, count] : results.patches_by_kind) patches[kind] = count;
  for (const auto& [name, count] : results.patches_by_status) status[name] = count;
  json["recovery"] = {{"patches", patches},
                      {"status", status},
                      {"grown_patches", results.grown_patches},
                      {"truncated_rows", results.truncated_rows},
                      {"inconsistent_patches", results.inconsistent_patches}};
  if (results.quadratic_patches > 0 || results.lowered_patches > 0)
    json["recovery"]["degree_2"] = {{"patches", results.quadratic_patches},
                                    {"degree_lowered", results.lowered_patches}};
  json["pressure_error"] = Json::array();
  for (const ZoneError& zone : results.pressure_errors)
    json["pressure_error"].push_back({{"zone", zone.zone}, {"raw", zone.raw}, {"spr", zone.spr}, {"sprc", zone.sprc}});
}

void add_solution(const Results& results, Json& json) {
  json["outer_iterations"] = results.outer_iterations;
  json["linear_iterations"] = results.linear_iterations;
  json["outer_residuals"] = results.outer_residuals;
  json["active_points"] = results.active_points;
  json["converged"] = results.converged;
  json["diagnosis"] = results.diagnosis;
  json["contact"] = Json::array();
  for (const PairFigures& pair : results.pairs) json["contact"].push_back(json_of(pair));
  if (!results.steps.empty()) json["steps"] = Json::array();
  for (const StepFigures& step : results.steps) json["steps"].push_back(json_of(step));
  json["supports"] = Json::array();
  for (const SupportFigures& support : results.supports)
    json["supports"].push_back({{"face", support.face}, {"force", json_of(support.force)}});
}

/// "  step 2 of 4 (everything times 0.5): inner-outer 12.3 kN on 0.2 m^2, up to 4 MPa".
std::string step_line(const Results& results, std::size_t k) {
  const StepFigures& s = results.steps[k];
  const bool alike = s.step.loads == s.step.displacements && s.step.loads == s.step.interference;
  const std::string factors = alike ? fmt::format("everything times {:g}", s.step.loads)
                                    : fmt::format("loads times {:g}, displacements {:g}, interference {:g}",
                                                  s.step.loads, s.step.displacements, s.step.interference);
  std::string text;
  for (const PairFigures& pair : s.pairs)
    text += fmt::format("{}{} {} on {} m^2, up to {}", text.empty() ? ": " : "; ", pair.name,
                        scaled(pair.force_on_first.norm(), "N", 5), short_number(pair.area),
                        scaled(pair.max_pressure, "Pa", 4));
  return fmt::format("  step {} of {} ({}){}{}\n", k + 1, results.steps.size(), factors, text,
                     s.converged ? "" : "; DID NOT CONVERGE");
}

std::string force_line(const PairFigures& pair) {
  const Vec3& f = pair.force_on_first;
  return fmt::format(
      "  contact {}: force on {} {} ({}, {}, {}), area {} m^2, max pressure {}; estimated errors: pressure {:.2g} %, "
      "force {:.2g} %\n",
      pair.name, pair.body_first, scaled(f.norm(), "N", 6), short_number(f[0]), short_number(f[1]), short_number(f[2]),
      short_number(pair.area), scaled(pair.max_pressure, "Pa", 5), 100 * pair.pressure_error_estimate,
      100 * pair.force_error_estimate);
}

/// "3 interior, 2 contact".
std::string counts_text(const std::vector<std::pair<std::string, long long>>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text;
}

std::string recovery_line(const Results& results) {
  long long total = 0;
  for (const auto& [kind, count] : results.patches_by_kind) total += count;
  std::string degree;
  if (results.quadratic_patches > 0 || results.lowered_patches > 0)
    degree = fmt::format("; {} of degree 2, {} lowered to 1", results.quadratic_patches, results.lowered_patches);
  return fmt::format("  recovery: {} patches ({}); {}{}; {} rows truncated\n", total,
                     counts_text(results.patches_by_kind), counts_text(results.patches_by_status), degree,
                     results.truncated_rows);
}

std::string times_line(const Results& results) {
  std::string phases;
  double total = 0;
  for (const auto& [phase, seconds] : results.times_s) {
    if (phase == "total") continue;
    phases += fmt::format("{}{} {:.3g}", phases.empty() ? "" : ", ", phase, seconds);
    total += seconds;
  }
  return fmt::format("  time: {:.3g} s ({}), peak memory {}, {} thread{} ({})\n", total, phases,
                     scaled(static_cast<double>(results.peak_memory_bytes), "B"), results.threads,
                     results.threads == 1 ? "" : "s", results.backend);
}

}  // namespace

void write_report(const Results& results, const std::vector<std::string>& files,
                  const std::vector<std::string>& warnings, const std::string& file_name) {
  Json json;
  json["program"] = "cgcontact";
  json["scene"] = results.scene_file;
  json["title"] = results.title;
  json["version"] = CGCONTACT_VERSION;
  json["backend"] = results.backend;
  json["threads"] = results.threads;
  json["unknowns"] = results.unknowns;
  json["cells"] = {{"active", results.cells.active}, {"cut", results.cells.cut}, {"interior", results.cells.interior}};
  add_solution(results, json);
  add_errors(results, json);
  Json times = object();
  for (const auto& [phase, seconds] : results.times_s) times[phase] = seconds;
  json["times_s"] = times;
  json["peak_memory_bytes"] = results.peak_memory_bytes;
  json["warnings"] = results.warnings;
  for (const std::string& warning : warnings) json["warnings"].push_back(warning);
  json["files"] = files;
  write_text(file_name, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::vector<std::string> files_of_report(const std::string& file_name) {
  const Json json = Json::parse(read_text(file_name), nullptr, false);
  const auto is_ours = [&] {
    if (!json.is_object() || json.value("program", Json()) != "cgcontact") return false;
    const Json files = json.value("files", Json());
    if (!files.is_array()) return false;
    for (const Json& file : files)
      if (!file.is_string()) return false;
    return true;
  };
  if (!is_ours()) throw InputError(fmt::format("{} is not a report of cgcontact", file_name));
  return json["files"].get<std::vector<std::string>>();
}

std::string summary(const Results& results, const std::string& directory) {
  std::string text = results.converged ? "solved" : "DID NOT CONVERGE";
  if (!results.title.empty()) text += fmt::format(": {}", results.title);
  text += '\n';
  if (!results.diagnosis.empty()) text += fmt::format("  diagnosis: {}\n", results.diagnosis);
  text += fmt::format("  {} cells ({} cut, {} interior), {} unknowns\n", results.cells.active, results.cells.cut,
                      results.cells.interior, results.unknowns);
  long long linear = 0;
  for (int n : results.linear_iterations) linear += n;
  text += fmt::format("  {} outer iterations, {} linear iterations", results.outer_iterations, linear);
  text += results.pairs.empty() ? "\n" : fmt::format(", {} active contact points\n", results.active_points);
  for (std::size_t k = 0; k < results.steps.size(); ++k) text += step_line(results, k);
  for (const PairFigures& pair : results.pairs) text += force_line(pair);
  text += fmt::format("  estimated error {:.3g} % of the energy norm", 100 * results.estimated_error_relative);
  if (results.has_effectivity) text += fmt::format(", effectivity {:.3f}", results.effectivity);
  text += '\n';
  for (const ZoneError& zone : results.pressure_errors)
    text += fmt::format("  pressure error, {}: raw {:.2g} %, SPR {:.2g} %, SPR-C {:.2g} %\n", zone.zone, 100 * zone.raw,
                        100 * zone.spr, 100 * zone.sprc);
  if (!results.patches_by_kind.empty()) text += recovery_line(results);
  if (!results.times_s.empty()) text += times_line(results);
  for (const std::string& warning : results.warnings) text += fmt::format("  warning: {}\n", warning);

  std::string files;
  for (const char* name :
       {"scene.png", "pressure.svg", "stress_error.svg", "steps.svg", "result.vtkhdf", "contact.csv", "steps.csv"})
    if (std::filesystem::exists(std::filesystem::path(directory) / name)) files += fmt::format(" {}", name);
  text += fmt::format("  results in {}:{} report.json\n", directory, files);
  return text;
}

}  // namespace cgcontact
