#include "core/results/report_figures.hpp"

#include <fmt/format.h>

#include "core/base/errors/errors.hpp"
#include "core/base/files/json.hpp"

namespace cgcontact {

namespace {

RunFigures figures_of(const Json& json) {
  RunFigures figures;
  figures.backend = json.at("backend");
  figures.threads = json.at("threads");
  figures.unknowns = json.at("unknowns");
  figures.active_cells = json.at("cells").at("active");
  figures.cut_cells = json.at("cells").at("cut");
  for (const Json& pair : json.at("contact")) {
    figures.contact_points += pair.at("points").get<long long>();
    const Json& force = pair.at("force").at(pair.at("bodies").at(0).get<std::string>());
    const double size = Vec3(force.at(0), force.at(1), force.at(2)).norm();
    figures.pairs.push_back({pair.at("name"), size, pair.at("area"), pair.at("max_pressure")});
    if (figures.force) continue;
    figures.force = size;
    figures.pressure_error_estimate = pair.at("pressure_error_estimate").get<double>();
    if (const auto& estimate = pair.at("force_error_estimate"); !estimate.is_null())
      figures.force_error_estimate = estimate.get<double>();
  }
  if (const auto accuracy = json.find("accuracy"); accuracy != json.end() && !accuracy->at("solves").empty())
    figures.smallest_cell = accuracy->at("solves").back().at("smallest_cell").get<double>();
  figures.active_points = json.at("active_points");
  figures.outer_iterations = json.at("outer_iterations");
  for (const Json& iterations : json.at("linear_iterations")) figures.linear_iterations += iterations.get<long long>();
  for (const auto& [phase, seconds] : json.at("times_s").items())
    if (phase != "total") figures.times_s.emplace_back(phase, seconds);
  figures.peak_memory_bytes = json.at("peak_memory_bytes");
  figures.converged = json.at("converged");
  figures.diagnosis = json.at("diagnosis");
  figures.warnings = json.at("warnings").get<std::vector<std::string>>();
  if (const Json verdict = json.value("verdict", Json());
      verdict.is_object() && (verdict.at("state") == "not_resolved" || verdict.at("state") == "contact_missed"))
    figures.warnings.insert(figures.warnings.begin(), verdict.at("text").get<std::string>());
  figures.estimated_error = json.at("estimated_error").at("absolute");
  figures.estimated_error_relative = json.at("estimated_error").at("relative");
  if (json.contains("effectivity")) figures.effectivity = json.at("effectivity").get<double>();
  for (const Json& zone : json.at("pressure_error"))
    figures.pressure_errors.push_back({zone.at("zone"), zone.at("raw"), zone.at("spr"), zone.at("sprc")});
  return figures;
}

}  // namespace

double RunFigures::total_time_s() const {
  double total = 0;
  for (const auto& [phase, seconds] : times_s) total += seconds;
  return total;
}

RunFigures read_figures(const std::string& report, const std::string& source) try {
  return figures_of(Json::parse(report));
} catch (const Json::exception& error) {
  throw InputError(fmt::format("{} is not a report of cgcontact ({})", source, error.what()));
}

}  // namespace cgcontact
