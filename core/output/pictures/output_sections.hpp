/// section_NAME.png: the bodies cut along a plane of the scene, coloured by one scalar.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/output/pictures/output_gnuplot.hpp"

namespace cgcontact {

/// "section_NAME.png"
std::string section_picture(const SectionSpec& section);

/// Draws undeformed sections, seen against the normal. A plane that meets no body is a warning. Needs the folder plots
/// of the result directory.
void write_sections(const Scene& scene, const std::vector<DrawnBody>& bodies, GnuplotRuns& runs);

}  // namespace cgcontact
