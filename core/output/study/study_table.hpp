/// The runs of a study and what is derived from several of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results/report_figures.hpp"

namespace cgcontact {

struct StudyRow {
  enum class Status { not_run, solved, not_converged, failed };

  // input of the run
  std::string variant, size;  ///< names of the curve and of the point on it
  std::string preconditioner;
  double cell_size = 0;                   ///< m, the largest of all bodies
  std::optional<double> force_reference;  ///< N
  std::string directory;                  ///< of the results, inside the study's
  std::vector<std::string> command;       ///< program and arguments
  std::string fingerprint;                ///< the same for runs with the same results

  // result of the run
  Status status = Status::not_run;
  std::string message;  ///< why it failed, or its warnings
  double wall_s = 0;    ///< of the whole process
  std::string report;   ///< text of report.json, empty if none
  RunFigures figures;
  std::vector<ZoneError> errors;  ///< of the pressure; empty: nothing to compare with

  bool has_figures() const { return !report.empty(); }
};

struct Study {
  std::string scene_file, title;
  std::string key;                    ///< what the sizes are values of; "refine": factors that divide all cell sizes
  std::string reference = "none";     ///< what the pressure is compared with
  bool own_reference = false;         ///< that is the finest run of the study
  std::vector<std::string> variants;  ///< in order
  std::vector<StudyRow> rows;         ///< all sizes of the first variant, then those of the next one
  int repeat = 1;
};

/// One of the three pressures.
struct PressureKind {
  const char *name, *key, *colour;
  double ZoneError::*error;
};
const std::vector<PressureKind>& pressure_kinds();

/// Errors below this are rounding: no rate, ratio or point in a plot.
constexpr double min_error = 1e-10;

const char* status_name(StudyRow::Status status);

/// Returns the solved run with the smallest cells, or null.
const StudyRow* finest_row(const Study& study);

/// Returns the names of all zones in order.
std::vector<std::string> zone_names(const Study& study);

/// Returns the names of all phases in order.
std::vector<std::string> phase_names(const Study& study);

/// Returns the error of a row in a zone, or nothing.
std::optional<double> pressure_error(const StudyRow& row, const std::string& zone, const PressureKind& kind);

/// Returns the error of plain SPR over that of the result.
std::optional<double> error_ratio(const StudyRow& row, const std::string& zone);

/// Returns the relative error of the contact force, if the row has a reference.
std::optional<double> force_error(const StudyRow& row);

/// Returns the observed order of convergence: log(coarse / fine) of the errors over that of the cell sizes, between
/// this row and the next coarser one of the same variant that has been solved.
std::optional<double> observed_rate(const Study& study, const StudyRow& row, const std::string& zone,
                                    const PressureKind& kind);

}  // namespace cgcontact
