/// Changes by repairs of surfaces from files, on request, for `check --out`.
#pragma once

#include <string>

#include "core/output/output_gnuplot.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Draws check_repair.png: each repaired surface from both sides, with the triangles that were not in its file in
/// colour, and what changed. Returns the picture's name, "" if nothing was repaired on request.
std::string draw_repairs(const Scene& scene, GnuplotRuns& runs);

}  // namespace cgcontact
