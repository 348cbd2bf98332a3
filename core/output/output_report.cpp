#include "core/output/output_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.hpp"
#include "core/base/text.hpp"

namespace cgcontact {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Vec3& v) { return Json::array({v[0], v[1], v[2]}); }

/// An object also when it has no entries.
Json object() { return Json::object(); }

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json json_of(const Verdict& verdict) {
  Json pairs = Json::array();
  for (const Verdict::Pair& pair : verdict.pairs)
    pairs.push_back({{"name", pair.name},
                     {"state", name_of(pair.state)},
                     {"cells_across", json_of(pair.cells_across)},
                     {"cell_size_needed", json_of(pair.cell_size_needed)}});
  return {{"state", name_of(verdict.state)}, {"text", verdict.text}, {"pairs", pairs}};
}

Json json_of(const PairFigures& pair) {
  Json json;
  json["name"] = pair.name;
  json["bodies"] = {pair.body_first, pair.body_second};
  json["force"] = {{pair.body_first, json_of(pair.force_on_first)}, {pair.body_second, json_of(pair.force_on_second)}};
  json["moment"] = {{pair.body_first, json_of(pair.moment_on_first)},
                    {pair.body_second, json_of(pair.moment_on_second)}};
  json["area"] = pair.area;
  json["centre"] = json_of(pair.centre);
  json["max_pressure"] = pair.max_pressure;
  json["max_pressure_at"] = json_of(pair.max_pressure_at);
  json["interference"] = pair.interference;
  json["points"] = pair.points;
  json["active_points"] = pair.active_points;
  json["pressure_error_estimate"] = pair.pressure_error_estimate;
  json["force_error_estimate"] = json_of(pair.force_error_estimate);
  json["max_pressure_error_estimate"] = json_of(pair.max_pressure_error_estimate);
  json["force_given_by_loads"] = pair.force_given_by_loads;
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

Json json_of(const AccuracyFigures& accuracy) {
  Json solves = Json::array(), targets = object();
  for (const BodyTarget& target : accuracy.stress_of_body) targets[target.body] = target.error;
  const auto by_body = [&](const SolveFigures& solve) {
    Json errors = object();
    for (std::size_t k = 0; k < solve.stress_of_body.size(); ++k)
      errors[accuracy.stress_of_body[k].body] = solve.stress_of_body[k];
    return errors;
  };
  for (const SolveFigures& solve : accuracy.solves)
    solves.push_back({{"unknowns", solve.unknowns},
                      {"seconds", solve.seconds},
                      {"outer_iterations", solve.outer_iterations},
                      {"levels", solve.levels},
                      {"smallest_cell", solve.smallest_cell},
                      {"converged", solve.converged},
                      {"pressure", json_of(solve.pressure)},
                      {"force", json_of(solve.force)},
                      {"stress", solve.stress},
                      {"stress_of_body", by_body(solve)},
                      {"change", json_of(solve.change)}});
  return {{"targets",
           {{"pressure", json_of(accuracy.pressure)},
            {"force", json_of(accuracy.force)},
            {"stress", json_of(accuracy.stress)},
            {"stress_of_body", targets}}},
          {"reached", accuracy.reached},
          {"text", accuracy.text},
          {"solves", solves}};
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
  json["active_points_of_iteration"] = results.active_of_iteration;
  json["active_points"] = results.active_points;
  json["converged"] = results.converged;
  json["diagnosis"] = results.diagnosis;
  json["contact"] = Json::array();
  for (const PairFigures& pair : results.pairs) json["contact"].push_back(json_of(pair));
  if (!results.steps.empty()) json["steps"] = Json::array();
  for (const StepFigures& step : results.steps) json["steps"].push_back(json_of(step));
  json["supports"] = Json::array();
  for (const SupportFigures& support : results.supports)
    json["supports"].push_back({{"face", support.face},
                                {"condition", support.condition},
                                {"area", support.area},
                                {"force", json_of(support.force)}});
  json["loads"] = Json::array();
  for (const LoadFigures& load : results.loads)
    json["loads"].push_back({{load.of_body ? "body" : "face", load.face},
                             {"condition", load.condition},
                             {load.of_body ? "volume" : "area", load.area},
                             {"force", json_of(load.force)}});
  json["balance"] = Json::array();
  for (const BodyBalance& body : results.balance)
    json["balance"].push_back({{"body", body.body},
                               {"loads", json_of(body.loads)},
                               {"supports", json_of(body.supports)},
                               {"contact", json_of(body.contact)}});
}

Json json_of(const SingularPlace& place) {
  return {{"body", place.body},
          {"faces", place.faces},
          {"at", json_of(place.x)},
          {"exponent", place.exponent},
          {"cell", place.cell}};
}

/// The largest values and their places, by body; null where nothing was drawn.
Json json_of_bodies(const Results& results) {
  Json bodies = Json::array();
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    const BodyFields& body = results.bodies[b];
    Json json{{"name", body.name}, {"E", body.material.youngs_modulus}, {"nu", body.material.poisson_ratio}};
    json["cell_size"] = body.cut_cells->grid.cell_size;
    if (const int levels = body.cut_cells->num_levels(); levels > 1)
      json["smallest_cell_size"] = body.cut_cells->grid.cell_size_of(levels - 1);
    json["cells"] = body.cut_cells->cells.size();
    json["cut_cells"] = body.cut_cells->moments.size();
    double squared = 0;
    for (const double e : body.error_of_cell) squared += e * e;
    json["estimated_error"] = std::sqrt(squared);
    if (b < results.extremes.size()) {
      const BodyExtremes& most = results.extremes[b];
      json["max_von_mises"] = most.von_mises;
      json["max_von_mises_at"] = json_of(most.von_mises_at);
      json["max_displacement"] = most.displacement;
      json["max_displacement_at"] = json_of(most.displacement_at);
    } else {
      for (const char* key : {"max_von_mises", "max_von_mises_at", "max_displacement", "max_displacement_at"})
        json[key] = nullptr;
    }
    bodies.push_back(json);
  }
  return bodies;
}

}  // namespace

std::string report_text(const Results& results, const std::vector<std::string>& files,
                        const std::vector<std::string>& warnings) {
  Json json;
  json["program"] = "cgcontact";
  json["scene"] = results.scene_file;
  json["title"] = results.title;
  json["verdict"] = json_of(results.verdict);
  if (results.accuracy.asked) {
    json["accuracy"] = json_of(results.accuracy);
    json["singular_places"] = Json::array();
    for (const SingularPlace& place : results.singular_places) json["singular_places"].push_back(json_of(place));
  }
  json["version"] = CGCONTACT_VERSION;
  json["command"] = results.command;
  json["backend"] = results.backend;
  json["threads"] = results.threads;
  json["unknowns"] = results.unknowns;
  json["cells"] = {{"active", results.cells.active}, {"cut", results.cells.cut}, {"interior", results.cells.interior}};
  json["bodies"] = json_of_bodies(results);
  add_solution(results, json);
  add_errors(results, json);
  Json times = object();
  for (const auto& [phase, seconds] : results.times_s) times[phase] = seconds;
  json["times_s"] = times;
  json["peak_memory_bytes"] = results.peak_memory_bytes;
  json["warnings"] = results.warnings;
  for (const std::string& warning : warnings) json["warnings"].push_back(warning);
  json["files"] = files;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_report(const Results& results, const std::vector<std::string>& files,
                  const std::vector<std::string>& warnings, const std::string& file_name) {
  write_text(file_name, report_text(results, files, warnings));
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

}  // namespace cgcontact
