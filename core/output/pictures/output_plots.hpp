/// pressure.svg and stress_error.svg, drawn by gnuplot.
#pragma once

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Names "pressure.svg" of the first pair, "pressure_2.svg" of the next one ...
std::string path_picture(std::size_t pair);

/// Returns the name of a pair's best pressure: that of SPR-C, or of a problem on the face.
const char* name_of_pressure(bool on_face);
/// Returns that of all pairs together.
const char* name_of_pressure(const Results& results);

/// Starts the plots the results have data for.
void write_plots(const Results& results, const Scene& scene, GnuplotRuns& runs);

}  // namespace cgcontact
