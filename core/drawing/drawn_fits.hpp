/// Exaggerated displacements without the gaps and overlaps that they tear into fits.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Closes spurious gaps and overlaps in exaggerated displacements: those of two touching faces differ by the
/// interference (not drawn) or by their first distance, which `exaggeration` magnifies. Each body takes half of the
/// difference, along the normal of the nearest closed contact point, falling to zero within a quarter of the body.
/// Changes DrawnBody::displacement only, and nothing if all faces meet within a pixel or so.
void draw_fits_closed(const Results& results, double exaggeration, std::vector<DrawnBody>& bodies);

}  // namespace cgcontact
