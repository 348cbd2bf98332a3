/// stress_error.svg: the error of the stress tensor over the contact faces, SPR beside SPR-C.
#pragma once

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Draws maps with one scale, or curves along the face when it is one-dimensional (plane strain): samples on a line or
/// on a circular arc once their thinnest direction is left out.
void write_stress_error_plot(const Results& results, GnuplotRuns& runs);

}  // namespace cgcontact
