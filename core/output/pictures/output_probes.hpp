/// probes.csv and probe_NAME.svg: values at the points that the scene asks for.
#pragma once

#include <optional>
#include <string>

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// The largest and the smallest value of a field over a probe; none where no point has one.
struct ProbeRange {
  Extreme smallest, largest;
};
std::optional<ProbeRange> range_of(const ProbeFigures& probe, std::size_t field);

/// Writes a row per point and body; columns of the fields that any probe asks for, empty where its own does not.
void write_probes_csv(const Results& results, const std::string& file_name);

/// "probe_NAME.svg"
std::string probe_picture(const ProbeFigures& probe);

/// Plots lines and circles with more than one point; needs the folder plots of the result directory.
void write_probe_plots(const Results& results, GnuplotRuns& runs);

}  // namespace cgcontact
