/// The picture of a result: pixels of what is shown, bar of colours, title, axes, the largest value.
#pragma once

#include <string>

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/plot/plot_values.hpp"

namespace cgcontact {

/// Starts drawing NAME.png in the directory of the runs.
void draw_plot(const PlotResult& result, const PlotOptions& options, const PlotField& field, const PlotShape& shape,
               const PlotValues& values, const std::string& name, GnuplotRuns& runs);

}  // namespace cgcontact
