#include "core/output/study/output_study.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "core/base/errors/errors.hpp"
#include "core/base/files/json.hpp"
#include "core/base/files/text.hpp"
#include "core/output/study/output_study_plots.hpp"
#include "core/program/scratch_folder.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

const char* const files[] = {"study.csv", "study.json", "error_time.svg", "error_unknowns.svg", "figures.svg"};
constexpr double much_finer = 2 * (1 - 1e-9);  ///< cells over those of the study's own reference (docs/study.md)

struct Column {
  std::string name;
  std::function<Json(const StudyRow&)> value;  ///< null: not known
};

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

/// Turns a phase or zone into a fragment of a column's name.
std::string column_name(std::string text) {
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

/// A column that only runs with a report have.
template <class Value>
Column figure(const std::string& name, const Value& value) {
  return {name, [value](const StudyRow& row) { return row.has_figures() ? Json(value(row.figures)) : Json(); }};
}

std::vector<Column> description_columns(const Study& study) {
  return {{"variant", [](const StudyRow& row) { return Json(row.variant); }},
          {"key", [key = study.key](const StudyRow&) { return Json(key); }},
          {"size", [](const StudyRow& row) { return Json(std::stod(row.size)); }},
          {"cell_size_m", [](const StudyRow& row) { return Json(row.cell_size); }},
          {"status", [](const StudyRow& row) { return Json(status_name(row.status)); }},
          {"preconditioner", [](const StudyRow& row) { return Json(row.preconditioner); }},
          figure("backend", [](const RunFigures& run) { return run.backend; }),
          figure("threads", [](const RunFigures& run) { return run.threads; }),
          figure("unknowns", [](const RunFigures& run) { return run.unknowns; }),
          figure("cells", [](const RunFigures& run) { return run.active_cells; }),
          figure("cut_cells", [](const RunFigures& run) { return run.cut_cells; }),
          figure("contact_points", [](const RunFigures& run) { return run.contact_points; }),
          figure("active_points", [](const RunFigures& run) { return run.active_points; }),
          figure("outer_iterations", [](const RunFigures& run) { return run.outer_iterations; }),
          figure("linear_iterations", [](const RunFigures& run) { return run.linear_iterations; })};
}

void add_cost_columns(const Study& study, std::vector<Column>& columns) {
  columns.push_back(figure("time_total_s", [](const RunFigures& run) { return run.total_time_s(); }));
  for (const std::string& phase : phase_names(study))
    columns.push_back({"time_" + column_name(phase) + "_s", [phase](const StudyRow& row) {
                         for (const auto& [name, seconds] : row.figures.times_s)
                           if (name == phase) return Json(seconds);
                         return Json();
                       }});
  columns.push_back({"wall_s", [](const StudyRow& row) { return Json(row.wall_s); }});
  columns.push_back(figure("peak_memory_bytes", [](const RunFigures& run) { return run.peak_memory_bytes; }));
}

void add_error_columns(const Study& study, std::vector<Column>& columns) {
  for (const std::string& zone : zone_names(study)) {
    const std::string name = column_name(zone);
    for (const PressureKind& kind : pressure_kinds())
      columns.push_back({fmt::format("error_{}_{}", name, kind.key),
                         [zone, kind](const StudyRow& row) { return optional(pressure_error(row, zone, kind)); }});
    columns.push_back({"ratio_" + name, [zone](const StudyRow& row) { return optional(error_ratio(row, zone)); }});
    for (const PressureKind& kind : pressure_kinds())
      columns.push_back({fmt::format("rate_{}_{}", name, kind.key), [zone, kind, &study](const StudyRow& row) {
                           return optional(observed_rate(study, row, zone, kind));
                         }});
  }
  columns.push_back(figure("estimated_error", [](const RunFigures& run) { return run.estimated_error; }));
  columns.push_back(
      figure("estimated_error_relative", [](const RunFigures& run) { return run.estimated_error_relative; }));
  columns.push_back(figure("effectivity", [](const RunFigures& run) { return optional(run.effectivity); }));
  columns.push_back(figure("contact_force_N", [](const RunFigures& run) { return optional(run.force); }));
  columns.push_back(figure("max_pressure_Pa", [](const RunFigures& run) {
    return run.pairs.empty() ? Json() : Json(run.pairs.front().max_pressure);
  }));
  columns.push_back(figure("contact_area_m2", [](const RunFigures& run) {
    return run.pairs.empty() ? Json() : Json(run.pairs.front().area);
  }));
  columns.push_back({"force_error", [](const StudyRow& row) { return optional(force_error(row)); }});
  columns.push_back(
      figure("pressure_error_estimate", [](const RunFigures& run) { return optional(run.pressure_error_estimate); }));
  columns.push_back(
      figure("force_error_estimate", [](const RunFigures& run) { return optional(run.force_error_estimate); }));
  columns.push_back({"message", [](const StudyRow& row) { return Json(row.message); }});
}

std::vector<Column> all_columns(const Study& study) {
  std::vector<Column> columns = description_columns(study);
  add_cost_columns(study, columns);
  add_error_columns(study, columns);
  return columns;
}

std::string csv_of(const Study& study) {
  const std::vector<Column> columns = all_columns(study);
  std::string text;
  for (const Column& column : columns) text += (text.empty() ? "" : ",") + csv_text(column.name);
  text += '\n';
  for (const StudyRow& row : study.rows) {
    if (row.status == StudyRow::Status::not_run) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Json value = columns[c].value(row);
      if (c > 0) text += ',';
      if (value.is_number_float() && !std::isfinite(value.get<double>())) continue;
      if (!value.is_null()) text += csv_text(value.is_string() ? value.get<std::string>() : value.dump());
    }
    text += '\n';
  }
  return text;
}

std::string json_of(const Study& study) {
  const std::vector<Column> columns = all_columns(study);
  Json json;
  json["program"] = "cgcontact";
  json["version"] = CGCONTACT_VERSION;
  json["scene"] = study.scene_file;
  json["title"] = study.title;
  json["reference"] = study.reference;
  json["reference_is_own_finest_run"] = study.own_reference;
  json["repeat"] = study.repeat;
  json["planned_runs"] = study.rows.size();
  json["complete"] = std::none_of(study.rows.begin(), study.rows.end(),
                                  [](const StudyRow& row) { return row.status == StudyRow::Status::not_run; });
  json["study"] = Json::array();
  for (const StudyRow& row : study.rows) {
    if (row.status == StudyRow::Status::not_run) continue;
    Json entry;
    for (const Column& column : columns) entry[column.name] = column.value(row);
    entry["command"] = row.command;
    entry["fingerprint"] = row.fingerprint;
    entry["report"] = row.has_figures() ? Json::parse(row.report) : Json();
    json["study"].push_back(entry);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Study.json of ours, or null.
Json earlier_study(const std::string& directory) {
  const fs::path file = fs::path(directory) / "study.json";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  Json json = Json::parse(read_text(file.string()), nullptr, false);
  const bool ours =
      json.is_object() && json.value("program", Json()) == "cgcontact" && json.value("study", Json()).is_array();
  return ours ? json : Json();
}

/// Columns as wide as their widest entry; the first one is set flush left.
std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : lines) {
    std::string row = "  ";
    for (std::size_t c = 0; c < line.size(); ++c)
      row += c == 0 ? fmt::format("{:<{}}", line[c], widths[c]) : fmt::format("  {:>{}}", line[c], widths[c]);
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  return text;
}

std::string percent_or_dash(const std::optional<double>& value) {
  return value ? fmt::format("{:.3g}", 100 * *value) : "-";
}

std::string with_decimals(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string cost_table(const Study& study) {
  std::vector<std::vector<std::string>> lines{{"variant", study.key, "unknowns", "cells", "points", "outer", "linear",
                                               "time [s]", "memory", "estimate [%]", "effectivity", "force [%]",
                                               "estimate [%]", "pressure est. [%]"}};
  for (const StudyRow& row : study.rows) {
    const RunFigures& run = row.figures;
    std::vector<std::string> line{row.variant, row.size};
    if (row.has_figures())
      line.insert(line.end(), {fmt::to_string(run.unknowns), fmt::to_string(run.active_cells),
                               fmt::to_string(run.contact_points), fmt::to_string(run.outer_iterations),
                               fmt::to_string(run.linear_iterations), fmt::format("{:.3g}", run.total_time_s()),
                               scaled(static_cast<double>(run.peak_memory_bytes), "B", 3),
                               percent_or_dash(run.estimated_error_relative), with_decimals(run.effectivity, 3),
                               percent_or_dash(force_error(row)), percent_or_dash(run.force_error_estimate),
                               percent_or_dash(run.pressure_error_estimate)});
    if (row.status != StudyRow::Status::solved) line.resize(lines[0].size(), "-");
    lines.push_back(line);
    if (row.status != StudyRow::Status::solved) lines.back().push_back(status_name(row.status));
  }
  std::size_t most = 0;
  for (const auto& line : lines) most = std::max(most, line.size());
  for (auto& line : lines) line.resize(most);
  return aligned(lines);
}

/// Force, largest pressure and area of the first pair over the sizes.
std::string figures_table(const Study& study) {
  std::vector<std::vector<std::string>> lines{{"variant", study.key, "force", "max pressure", "area"}};
  for (const StudyRow& row : study.rows) {
    if (row.status != StudyRow::Status::solved || row.figures.pairs.empty()) continue;
    const RunFigures::Pair& pair = row.figures.pairs.front();
    const auto text = [](double value, const DisplayUnit& unit) {
      return short_number(value * unit.factor, 5) + " " + unit.name;
    };
    lines.push_back({row.variant, row.size, text(pair.force, force_unit(pair.force)),
                     text(pair.max_pressure, stress_unit(pair.max_pressure)), text(pair.area, area_unit(pair.area))});
  }
  return lines.size() < 2 ? "" : fmt::format("contact, first pair\n{}", aligned(lines));
}

std::string error_table(const Study& study, const std::string& zone) {
  std::vector<std::vector<std::string>> lines{
      {"variant", study.key, "raw [%]", "SPR [%]", "result [%]", "SPR/result", "rate raw", "rate SPR", "rate result"}};
  for (const StudyRow& row : study.rows) {
    if (row.errors.empty() || row.status != StudyRow::Status::solved) continue;
    std::vector<std::string> line{row.variant, row.size};
    for (const PressureKind& kind : pressure_kinds()) line.push_back(percent_or_dash(pressure_error(row, zone, kind)));
    line.push_back(with_decimals(error_ratio(row, zone), 2));
    for (const PressureKind& kind : pressure_kinds())
      line.push_back(with_decimals(observed_rate(study, row, zone, kind), 2));
    lines.push_back(line);
  }
  return lines.size() < 2 ? "" : fmt::format("pressure error, {}\n{}", zone, aligned(lines));
}

/// Sizes that are too near the study's own reference.
std::string too_fine(const Study& study) {
  const StudyRow* const finest = study.own_reference ? finest_row(study) : nullptr;
  std::vector<std::string> sizes;
  for (const StudyRow& row : study.rows) {
    const bool near = finest && !row.errors.empty() && row.cell_size < much_finer * finest->cell_size;
    if (near && std::find(sizes.begin(), sizes.end(), row.size) == sizes.end()) sizes.push_back(row.size);
  }
  if (sizes.empty()) return "";
  return fmt::format("errors of {} = {} may come out too small: that run's cells are not half as large\n", study.key,
                     fmt::join(sizes, ", "));
}

}  // namespace

std::vector<std::string> write_study(const Study& study, const std::string& directory) try {
  const fs::path target(directory);
  const ScratchFolder folder(target / fmt::format(".tmp-{}", getpid()));
  const fs::path& temporary = folder.path();
  std::vector<std::string> warnings;
  fs::create_directory(temporary / "plots");
  write_text((temporary / "study.csv").string(), csv_of(study));
  write_text((temporary / "study.json").string(), json_of(study));
  write_study_plots(study, temporary.string(), warnings);
  fs::remove_all(target / "plots");
  if (!warnings.empty()) fs::rename(temporary / "plots", target / "plots");
  for (const char* file : files)
    if (fs::exists(temporary / file))
      fs::rename(temporary / file, target / file);
    else
      fs::remove(target / file);
  return warnings;
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write the study to {}: {}", directory, error.code().message()));
}

void check_study_directory(const std::string& directory) try {
  const fs::path target(directory);
  if (!fs::exists(target)) return;
  if (!fs::is_directory(target))
    throw InputError(fmt::format("cannot write the study to {}: it is not a directory", directory));
  if (!fs::is_empty(target) && earlier_study(directory).is_null())
    throw InputError(fmt::format(
        "will not write the study to {}: it is not empty and holds no study.json of an earlier study", directory));
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write the study to {}: {}", directory, error.code().message()));
}

std::map<std::string, StudyRow> earlier_rows(const std::string& directory) {
  std::map<std::string, StudyRow> rows;
  const Json json = earlier_study(directory);
  if (json.is_null()) return rows;
  for (const Json& entry : json["study"]) {
    const auto text = [&](const char* key) {
      const Json value = entry.is_object() ? entry.value(key, Json()) : Json();
      return value.is_string() ? value.get<std::string>() : "";
    };
    if (!entry.is_object() || !entry.value("report", Json()).is_object() || text("fingerprint").empty()) continue;
    StudyRow row;
    row.status = text("status") == "solved" ? StudyRow::Status::solved : StudyRow::Status::not_converged;
    row.message = text("message");
    row.wall_s = entry.value("wall_s", Json()).is_number() ? entry["wall_s"].get<double>() : 0;
    row.report = entry["report"].dump();
    row.figures = read_figures(row.report, (fs::path(directory) / "study.json").string());
    rows[text("fingerprint")] = row;
  }
  return rows;
}

std::string study_summary(const Study& study, const std::string& directory) {
  const auto count = [&](StudyRow::Status status) {
    return std::count_if(study.rows.begin(), study.rows.end(),
                         [&](const StudyRow& row) { return row.status == status; });
  };
  std::string text =
      fmt::format("study of {}: {} of {} runs solved", study.title, count(StudyRow::Status::solved), study.rows.size());
  for (const auto status : {StudyRow::Status::not_converged, StudyRow::Status::failed, StudyRow::Status::not_run})
    if (count(status) > 0) text += fmt::format(", {} {}", count(status), status_name(status));
  text += fmt::format("\nreference of the pressure: {}\n", study.reference);
  text += too_fine(study);
  if (study.repeat > 1) text += fmt::format("each time is the smallest of {} runs\n", study.repeat);
  text += cost_table(study);
  text += figures_table(study);
  for (const std::string& zone : zone_names(study)) text += error_table(study, zone);
  for (const StudyRow& row : study.rows)
    if (!row.message.empty()) text += fmt::format("{}, {} = {}: {}\n", row.variant, study.key, row.size, row.message);
  std::string names;
  for (const char* file : files)
    if (fs::exists(fs::path(directory) / file)) names += fmt::format(" {}", file);
  return text + fmt::format("results in {}:{}\n", directory, names);
}

}  // namespace cgcontact
