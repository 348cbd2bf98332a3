/// scene.png: the deformed bodies coloured by the von Mises stress of the recovered field.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/drawing/scene_view.hpp"
#include "core/output/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// `scene`: look_at_scene of the bodies. Needs the folder plots of the result directory.
void write_picture(const Results& results, const std::vector<DrawnBody>& bodies, const SceneView& scene,
                   GnuplotRuns& runs);

}  // namespace cgcontact
