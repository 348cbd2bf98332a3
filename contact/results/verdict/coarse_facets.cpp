#include "contact/results/verdict/coarse_facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Radians between neighbours of one smooth patch that make it curved.
constexpr double curved = 0.01;

}  // namespace

std::vector<std::string> coarse_facet_warnings(const SolvedState& state) {
  std::vector<std::string> warnings;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    const BodyModel& body = state.bodies[b];
    const BodyGeometry& geometry = body.cut_cells.solid.geometry();
    double widest = 0, in_cells = 0;  // m
    for (const ContactPair& pair : state.pairs) {
      if (pair.primary != b && pair.secondary != b) continue;
      for (const ContactPoint& q : pair.points)
        if (q.active) {
          const bool primary = pair.primary == b;
          const double width = geometry.facet_width(primary ? q.primary_position : q.secondary_position, curved);
          widest = std::max(widest, width * body.cut_cells.grid.cell_size);
          in_cells =
              std::max(in_cells, std::ldexp(width, body.cut_cells.level(primary ? q.primary_cell : q.secondary_cell)));
        }
    }
    if (in_cells > 1)
      warnings.push_back(fmt::format(
          "body \"{}\": its triangles are up to {:.2g} cells wide where it touches, {:.3g} m, and meet at an angle: "
          "the pressure follows their edges; a finer surface is needed, not finer cells",
          body.spec->name, in_cells, widest));
  }
  return warnings;
}

}  // namespace cgcontact
