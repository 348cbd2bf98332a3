/// scene.png: the deformed bodies coloured by the von Mises stress of the recovered field.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/output/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Thin bodies (at most two cells across) are seen from the front, others from above at an angle, cut open
/// where the contact lies inside. Needs the folder plots of the result directory.
void write_picture(const Results& results, const std::vector<DrawnBody>& bodies, GnuplotRuns& runs);

}  // namespace cgcontact
