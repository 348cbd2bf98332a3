/// Exaggerated displacements without the gaps and overlaps that they tear into fits.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Closes spurious gaps and overlaps in exaggerated displacements. The displacements of two faces that touch differ by
/// the interference (they are drawn without it) or by their first distance, and `exaggeration` magnifies that
/// difference. Half of it is given to each body, along the normal of the nearest closed contact point, falling to zero
/// within a quarter of the body. Changes DrawnBody::displacement only, and nothing if all faces meet within a pixel or
/// so.
void draw_fits_closed(const Results& results, double exaggeration, std::vector<DrawnBody>& bodies);

}  // namespace cgcontact
