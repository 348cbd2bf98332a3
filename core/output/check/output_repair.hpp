/// Changes by repairs of surfaces from files, on request, for `check --out`.
#pragma once

#include <string>

#include "core/output/pictures/output_gnuplot.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Draws check_repair.png: each repaired surface from both sides, with new triangles in colour, and the changes.
/// Returns the picture's name, "" without repairs on request.
std::string draw_repairs(const Scene& scene, GnuplotRuns& runs);

}  // namespace cgcontact
