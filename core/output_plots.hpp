/// pressure.svg and stress_error.svg, drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "core/results.hpp"

namespace cgcontact {

/// Writes the plots the results have data for into `directory`, scripts and data into its folder plots. Returns
/// warnings.
void write_plots(const Results& results, const Scene& scene, const std::string& directory,
                 std::vector<std::string>& warnings);

}  // namespace cgcontact
