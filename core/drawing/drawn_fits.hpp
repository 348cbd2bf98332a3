/// Exaggerated displacements without the gaps and overlaps that they tear into fits.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Of two faces that touch, the displacements differ by the interference (they are drawn without it) or by the distance
/// that they were apart. Drawn `exaggeration` times as large, that difference becomes a gap or an overlap that is not
/// there. So the bodies of each pair are drawn as if their faces met: half of the difference is given to each body,
/// along the normal of the nearest closed contact point, and falls to zero within a quarter of the body. Changes
/// DrawnBody::displacement only, and nothing if all faces meet within a pixel or so.
void draw_fits_closed(const Results& results, double exaggeration, std::vector<DrawnBody>& bodies);

}  // namespace cgcontact
