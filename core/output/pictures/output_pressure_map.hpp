/// pressure_map.png, pressure_map_2.png ...: the contact pressure over the contact face of each pair.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

struct PressureMap {
  std::size_t pair;  ///< index into Results::pairs
  std::string file, caption;
};

/// Returns the pairs that are drawn, in order: of many those with the largest forces.
std::vector<std::size_t> pairs_to_draw(const Results& results);

/// Starts drawing the recovered pressure on the face of the body with the smaller cells, with the edge of the contact
/// zone (1 % of the largest pressure). Nearly flat faces are seen along a coordinate axis, cylindrical ones are
/// unrolled, others seen along their mean normal. Faces across which nothing varies (plane strain, revolution) or that
/// are much longer than wide become curves, mirrored where a plane of symmetry cuts the zone. Of many pairs those with
/// the largest forces are drawn.
std::vector<PressureMap> write_pressure_maps(const Results& results, const ContactSurface& surface, GnuplotRuns& runs);

}  // namespace cgcontact
