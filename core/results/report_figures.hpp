/// Reads a report.json back.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// The figures of one run that can be compared with those of others.
struct RunFigures {
  std::string backend;
  int threads = 0;
  long long unknowns = 0, active_cells = 0, cut_cells = 0, contact_points = 0, active_points = 0;
  int outer_iterations = 0;
  long long linear_iterations = 0;                      ///< of all outer iterations
  std::vector<std::pair<std::string, double>> times_s;  ///< phases in order
  long long peak_memory_bytes = 0;
  bool converged = false;
  std::string diagnosis;
  std::vector<std::string> warnings;
  double estimated_error = 0, estimated_error_relative = 0;
  std::optional<double> effectivity;
  std::optional<double> force;                                          ///< N, of the first contact pair
  std::optional<double> pressure_error_estimate, force_error_estimate;  ///< relative, of the first contact pair
  std::vector<ZoneError> pressure_errors;
  std::optional<double> smallest_cell;  ///< m, of a run to an accuracy
  struct Pair {
    std::string name;
    double force = 0, area = 0, max_pressure = 0;  ///< N, m^2, Pa
  };
  std::vector<Pair> pairs;

  double total_time_s() const;
};

/// `report` is the text of a report.json; throws InputError (with `source`) if it is not one.
RunFigures read_figures(const std::string& report, const std::string& source);

}  // namespace cgcontact
