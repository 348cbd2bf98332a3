/// accuracy.svg: the estimated errors of the solves of a run to an accuracy with its targets, and the time they took.
#pragma once

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Draws nothing for runs without [accuracy] or without any estimate.
void write_accuracy_plot(const Results& results, GnuplotRuns& runs);

}  // namespace cgcontact
