/// grid.png: the cells of a locally refined grid and the estimated error in them, of the whole scene and near the
/// contact zone.
#pragma once

#include "core/drawing/scene_view.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Draws the grids of runs to an accuracy and grids of several levels; nothing for others. `scene`: look_at_scene of
/// the bodies; `zone`: nullptr if there is none. Needs the folder plots of the result directory.
void write_grid_picture(const Results& results, const SceneView& scene, const ZoneLook* zone, GnuplotRuns& runs);

}  // namespace cgcontact
