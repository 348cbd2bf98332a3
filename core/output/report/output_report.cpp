#include "core/output/report/output_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "core/base/errors/errors.hpp"
#include "core/base/files/json.hpp"
#include "core/base/files/text.hpp"
#include "core/cells/grid.hpp"
#include "core/drawing/extremes.hpp"
#include "core/output/pictures/output_probes.hpp"
#include "core/results/answer.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

namespace {

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
  return {{"state", name_of(verdict.state)},
          {"text", verdict.text},
          {"pairs", pairs},
          {"spring_share", verdict.spring_share > 0 ? Json(verdict.spring_share) : Json(nullptr)}};
}

Json json_of(const MomentAbout& moment, const PairFigures& pair) {
  Json json{{"point", json_of(moment.point)},
            {"moment", {{pair.body_first, json_of(moment.on_first)}, {pair.body_second, json_of(moment.on_second)}}}};
  if (moment.axis) {
    json["axis"] = json_of(*moment.axis);
    json["about_axis"] = {{pair.body_first, *moment.about_axis_first}, {pair.body_second, *moment.about_axis_second}};
  }
  return json;
}

void add_zone(const PairFigures& pair, Json& json) {
  const ZoneFigures& zone = pair.zone;
  json["normal_force"] = zone.normal_force;
  json["mean_pressure"] = zone.mean_pressure;
  json["whole"] = {
      {"parts", zone.sectors}, {"normal_force", zone.sectors * zone.normal_force}, {"area", zone.sectors * pair.area}};
  if (zone.moment) json["moment_about"] = json_of(*zone.moment, pair);
  json["zone"] = nullptr;
  if (zone.extent)
    json["zone"] = {{"shape", name_of(zone.extent->shape)},
                    {"half_axes", zone.extent->half_axes},
                    {"directions", {json_of(zone.extent->directions[0]), json_of(zone.extent->directions[1])}}};
  json["hertz"] = nullptr;
  if (zone.hertz) json["hertz"] = {{"a", json_of(zone.hertz->a)}, {"b", zone.hertz->b}, {"p0", zone.hertz->p0}};
}

Json json_of(const FrictionFigures& friction) {
  Json json{{"coefficient", friction.coefficient},
            {"capacity", friction.capacity},
            {"capacity_error_estimate", json_of(friction.error)},
            {"whole", friction.whole},
            {"torque", nullptr}};
  if (const auto& torque = friction.torque)
    json["torque"] = {{"capacity", torque->capacity},
                      {"capacity_error_estimate", json_of(torque->error)},
                      {"whole", torque->whole},
                      {"carried", torque->carried},
                      {"point", json_of(torque->axis.point)},
                      {"axis", json_of(torque->axis.direction)},
                      {"axis_from", name_of(torque->from)}};
  else
    json["no_torque"] = friction.why_no_torque;
  json["use"] = json_of(friction.use);
  json["force_on_first"] = json_of(friction.force);
  json["stick_area"] = friction.stick_area;
  json["slip_area"] = friction.slip_area;
  json["max_slip"] = friction.max_slip;
  json["work"] = friction.work;
  json["wear"] = friction.wear;
  json["shear_error_estimate"] = json_of(friction.shear_error);
  json["verdict"] = verdict_on(friction);
  return json;
}

Json json_of(const PairFigures& pair) {
  Json json;
  json["name"] = pair.name;
  json["bodies"] = {pair.body_first, pair.body_second};
  if (pair.bonded) json["bonded"] = true;
  json["force"] = {{pair.body_first, json_of(pair.force_on_first)}, {pair.body_second, json_of(pair.force_on_second)}};
  json["moment"] = {{pair.body_first, json_of(pair.moment_on_first)},
                    {pair.body_second, json_of(pair.moment_on_second)}};
  json["area"] = pair.area;
  json["centre"] = json_of(pair.centre);
  json["max_pressure"] = pair.max_pressure;
  json["max_pressure_at"] = json_of(pair.max_pressure_at);
  json["interference"] = pair.interference;
  if (pair.preload) json["preload"] = *pair.preload;
  json["points"] = pair.points;
  json["active_points"] = pair.active_points;
  json["pressure_error_estimate"] = pair.pressure_error_estimate;
  json["force_error_estimate"] = json_of(pair.force_error_estimate);
  json["max_pressure_error_estimate"] = json_of(pair.max_pressure_error_estimate);
  json["force_given_by_loads"] = pair.force_given_by_loads;
  json["pressure_from"] = pair.pressure_on_face ? "face" : "stress";
  json["zones_of_stress"] = pair.zones_of_stress;
  json["least_gap"] = pair.min_gap ? Json(*pair.min_gap) : Json();
  json["least_gap_error"] = pair.min_gap_error ? Json(*pair.min_gap_error) : Json();
  add_zone(pair, json);
  if (pair.friction) json["friction"] = json_of(*pair.friction);
  return json;
}

Json json_of(const StepFigures& step) {
  Json contact = Json::array();
  for (const PairFigures& pair : step.pairs) {
    contact.push_back({{"name", pair.name},
                       {"force", json_of(pair.force_on_first)},
                       {"normal_force", pair.zone.normal_force},
                       {"area", pair.area},
                       {"max_pressure", pair.max_pressure}});
    if (pair.friction) contact.back()["friction"] = json_of(*pair.friction);
  }
  return {{"loads", step.step.loads},
          {"displacements", step.step.displacements},
          {"interference", step.step.interference},
          {"outer_iterations", step.outer_iterations},
          {"converged", step.converged},
          {"max_displacement", step.displacement ? Json(*step.displacement) : Json()},
          {"contact", contact}};
}

/// Values of the targets of one kind by their names.
Json by_name(const AccuracyFigures& accuracy, NamedTarget::Kind kind,
             const std::function<Json(std::size_t number)>& value) {
  Json values = object();
  for (std::size_t k = 0; k < accuracy.named.size(); ++k)
    if (accuracy.named[k].kind == kind) values[accuracy.named[k].name] = value(k);
  return values;
}

Json json_of(const AccuracyFigures& accuracy) {
  const auto asked = [&](std::size_t k) { return Json(accuracy.named[k].error); };
  Json solves = Json::array(), targets = object();
  for (const BodyTarget& target : accuracy.stress_of_body) targets[target.body] = target.error;
  const auto by_body = [&](const SolveFigures& solve) {
    Json errors = object();
    for (std::size_t k = 0; solve.converged && k < solve.stress_of_body.size(); ++k)
      errors[accuracy.stress_of_body[k].body] = solve.stress_of_body[k];
    return errors;
  };
  for (const SolveFigures& solve : accuracy.solves) {
    const auto error = [&](std::size_t k) { return k < solve.named.size() ? json_of(solve.named[k]) : Json(); };
    solves.push_back({{"unknowns", solve.unknowns},
                      {"seconds", solve.seconds},
                      {"outer_iterations", solve.outer_iterations},
                      {"levels", solve.levels},
                      {"smallest_cell", solve.smallest_cell},
                      {"converged", solve.converged},
                      {"pressure", json_of(solve.pressure)},
                      {"force", json_of(solve.force)},
                      {"shear", json_of(solve.shear)},
                      {"stress", solve.converged ? Json(solve.stress) : Json()},
                      {"stress_of_body", by_body(solve)},
                      {"displacement", by_name(accuracy, NamedTarget::Kind::displacement, error)},
                      {"pressure_of_pair", by_name(accuracy, NamedTarget::Kind::pressure, error)},
                      {"change", json_of(solve.change)}});
  }
  return {{"targets",
           {{"pressure", json_of(accuracy.pressure)},
            {"force", json_of(accuracy.force)},
            {"shear", json_of(accuracy.shear)},
            {"stress", json_of(accuracy.stress)},
            {"stress_of_body", targets},
            {"displacement", by_name(accuracy, NamedTarget::Kind::displacement, asked)},
            {"pressure_of_pair", by_name(accuracy, NamedTarget::Kind::pressure, asked)}}},
          {"reached", accuracy.reached},
          {"text", accuracy.text},
          {"answer", answer_of(accuracy) + 1},
          {"seconds", accuracy.seconds},
          {"solves", solves}};
}

Json json_of(const ProbeFigures& probe) {
  static const char* const kinds[] = {"point", "line", "circle", "face"};
  Json fields = object();
  for (std::size_t f = 0; f < probe.fields.size(); ++f) {
    Json& field = fields[name_of(probe.fields[f])];
    const auto range = range_of(probe, f);
    if (!range) continue;
    field = {{"min", range->smallest.value},
             {"min_at", json_of(range->smallest.at)},
             {"max", range->largest.value},
             {"max_at", json_of(range->largest.at)}};
  }
  return {{"name", probe.name},
          {"kind", kinds[static_cast<int>(probe.kind)]},
          {"points", probe.points},
          {"outside", probe.outside},
          {"values", probe.samples.size()},
          {"fields", fields}};
}

void add_errors(const Results& results, Json& json) {
  json["estimated_error"] = {{"absolute", results.estimated_error},
                             {"relative", results.estimated_error_relative},
                             {"displacement", results.displacement_error_estimate}};
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

/// Describes both hierarchies.
Json json_of(const LinearSolverFigures& solver) {
  Json grids = Json::array();
  for (std::size_t l = 0; l < solver.grid_unknowns.size(); ++l)
    grids.push_back({{"unknowns", solver.grid_unknowns[l]}, {"cycles", solver.cycles_of_grid[l]}});
  Json muelu = "direct";
  if (solver.muelu_unknowns.size() != 1) muelu = solver.muelu_unknowns;
  return {{"method", solver.method},
          {"preconditioner", solver.preconditioner},
          {"grids", grids},
          {"muelu", muelu},
          {"muelu_setups", solver.muelu_setups}};
}

void add_solution(const Results& results, Json& json) {
  for (const CoarseSolve& solve : results.coarse_solves)
    json["coarse_solves"].push_back(
        {{"unknowns", solve.unknowns}, {"outer_iterations", solve.outer_iterations}, {"converged", solve.converged}});
  json["outer_iterations"] = results.outer_iterations;
  json["linear_iterations"] = results.linear_iterations;
  json["linear_solver"] = json_of(results.linear_solver);
  json["outer_residuals"] = results.outer_residuals;
  json["active_points_of_iteration"] = results.active_of_iteration;
  json["active_points"] = results.active_points;
  json["converged"] = results.converged;
  json["diagnosis"] = results.diagnosis;
  json["contact"] = Json::array();
  for (const PairFigures& pair : results.pairs) json["contact"].push_back(json_of(pair));
  if (has_friction(results)) json["friction"] = friction_note;
  if (!results.probes.empty()) json["probes"] = Json::array();
  for (const ProbeFigures& probe : results.probes) json["probes"].push_back(json_of(probe));
  if (!results.steps.empty()) json["steps"] = Json::array();
  for (const StepFigures& step : results.steps) json["steps"].push_back(json_of(step));
  json["supports"] = Json::array();
  for (const SupportFigures& support : results.supports)
    json["supports"].push_back({{"face", support.face},
                                {"condition", support.condition},
                                {"area", support.area},
                                {"force", json_of(support.force)},
                                {"moment", json_of(support.moment)},
                                {"about", json_of(support.about)}});
  json["loads"] = Json::array();
  for (const LoadFigures& load : results.loads)
    json["loads"].push_back({{load.of_body ? "body" : "face", load.face},
                             {"condition", load.condition},
                             {load.of_body ? "volume" : "area", load.area},
                             {"force", json_of(load.force)},
                             {"moment", json_of(load.moment)},
                             {"about", json_of(load.about)}});
  json["balance"] = Json::array();
  for (const BodyBalance& body : results.balance) {
    json["balance"].push_back({{"body", body.body},
                               {"loads", json_of(body.loads)},
                               {"supports", json_of(body.supports)},
                               {"contact", json_of(body.contact)},
                               {"holds", json_of(body.holds)}});
  }
}

Json json_of(const SingularPoint& point) {
  return {{"body", point.body},
          {"faces", point.faces},
          {"at", json_of(point.x)},
          {"exponent", point.exponent},
          {"cell", point.cell}};
}

/// Adds a value and its position under two keys.
void add(const std::string& key, const Extreme& extreme, Json& json) {
  json[key] = extreme.value;
  json[key + "_at"] = json_of(extreme.at);
}

void add_extremes(const Extremes& most, Json& json) {
  add("max_von_mises", most.von_mises, json);
  add("max_displacement", most.displacement, json);
  add("max_tresca", most.tresca, json);
  add("max_principal", most.tension, json);
  add("min_principal", most.compression, json);
  if (most.pressure) add("max_pressure", *most.pressure, json);
  if (most.safety_factor) json["safety_factor"] = *most.safety_factor;
}

/// The largest values of all bodies, with the body.
Json json_of_maxima(const Results& results) {
  Json maxima = object();
  const auto add_kind = [&](const char* name, Extreme Extremes::*kind, bool smallest) {
    const int b = smallest ? body_with_smallest(results.extremes, kind) : body_with_largest(results.extremes, kind);
    if (b < 0) return;
    const Extreme& most = results.extremes[b].body.*kind;
    maxima[name] = {{"value", most.value}, {"body", results.bodies[b].name}, {"at", json_of(most.at)}};
  };
  add_kind("von_mises", &Extremes::von_mises, false);
  add_kind("tresca", &Extremes::tresca, false);
  add_kind("principal", &Extremes::tension, false);
  add_kind("min_principal", &Extremes::compression, true);
  add_kind("displacement", &Extremes::displacement, false);
  return maxima;
}

Json json_of(const RigidFigures& rigid) {
  return {
      {"centre", json_of(rigid.centre)},
      {"displacement", json_of(rigid.displacement)},
      {"rotation", json_of(rigid.rotation)},
      {"moments",
       {{"loads", json_of(rigid.loads)}, {"supports", json_of(rigid.supports)}, {"contact", json_of(rigid.contact)}}}};
}

/// Names the axis of a body in plane strain or of revolution.
void add_kind(const Grid& grid, Json& json) {
  if (grid.is_axisymmetric())
    json["axisymmetric"] = coordinate_names()[grid.axis_of_revolution()];
  else if (grid.plane_strain >= 0)
    json["plane_strain"] = coordinate_names()[grid.plane_strain];
}

/// Lists the bodies with the largest values and their positions.
Json json_of_bodies(const Results& results) {
  Json bodies = Json::array();
  for (std::size_t b = 0; b < results.bodies.size(); ++b) {
    const BodyFields& body = results.bodies[b];
    Json json{{"name", body.name}};
    if (body.rigid) {
      json["rigid"] = json_of(*body.rigid);
    } else {
      json["E"] = body.material.youngs_modulus;
      json["nu"] = body.material.poisson_ratio;
    }
    add_kind(body.cut_cells->grid, json);
    json["cell_size"] = body.cut_cells->grid.cell_size;
    if (const int levels = body.cut_cells->num_levels(); levels > 1)
      json["smallest_cell_size"] = body.cut_cells->grid.cell_size_of(levels - 1);
    json["cells"] = body.cut_cells->cells.size();
    json["cut_cells"] = body.cut_cells->active_of_cut.size();
    double squared = 0;
    for (const double e : body.error_of_cell) squared += e * e;
    json["estimated_error"] = std::sqrt(squared);
    if (b < results.extremes.size()) {
      add_extremes(results.extremes[b].body, json);
      json["faces"] = Json::array();
      for (const auto& [name, most] : results.extremes[b].faces) {
        Json face{{"name", name}};
        add_extremes(most, face);
        json["faces"].push_back(face);
      }
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
    for (const SingularPoint& point : results.singular_points) json["singular_places"].push_back(json_of(point));
  }
  json["version"] = CGCONTACT_VERSION;
  json["command"] = results.command;
  json["backend"] = results.backend;
  json["threads"] = results.threads;
  json["ranks"] = results.ranks;
  json["unknowns"] = results.unknowns;
  json["cells"] = {{"active", results.cells.active},
                   {"cut", results.cells.cut},
                   {"interior", results.cells.interior},
                   {"joined", results.cells.joined}};
  json["maxima"] = json_of_maxima(results);
  json["bodies"] = json_of_bodies(results);
  add_solution(results, json);
  add_errors(results, json);
  Json times = object();
  for (const auto& [phase, seconds] : results.times_s) times[phase] = seconds;
  json["times_s"] = times;
  json["peak_memory_bytes"] = results.peak_memory_bytes;
  for (const RankFigures& rank : results.rank_figures)
    json["rank_figures"].push_back({{"unknowns", rank.unknowns},
                                    {"ghost_unknowns", rank.ghosts},
                                    {"cut_cells", rank.cut_cells},
                                    {"messages", rank.messages},
                                    {"sent_bytes", rank.sent_bytes},
                                    {"reductions", rank.reductions},
                                    {"reduced_bytes", rank.reduced_bytes},
                                    {"peak_memory_bytes", rank.peak_memory_bytes}});
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
