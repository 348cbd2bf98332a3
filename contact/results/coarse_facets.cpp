#include "contact/results/coarse_facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Radians between neighbours of one smooth patch that make it curved.
constexpr double curved = 0.01;

}  // namespace

FacetWidth widest_facet(const SolvedState& state, const ContactPair& pair, int body) {
  FacetWidth widest;
  const CutCells& cells = state.bodies[body].cut_cells;
  const bool primary = pair.primary == body;
  for (const ContactPoint& q : pair.points) {
    if (!q.active) continue;
    const double width =
        cells.solid.geometry().facet_width(primary ? q.primary_position : q.secondary_position, curved);
    widest.metres = std::max(widest.metres, width * cells.grid.cell_size);
    widest.cells = std::max(widest.cells, std::ldexp(width, cells.level(primary ? q.primary_cell : q.secondary_cell)));
  }
  return widest;
}

std::vector<std::string> coarse_facet_warnings(const SolvedState& state) {
  std::vector<std::string> warnings;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    FacetWidth widest;
    for (const ContactPair& pair : state.pairs) {
      if (pair.primary != b && pair.secondary != b) continue;
      const FacetWidth here = widest_facet(state, pair, b);
      widest.metres = std::max(widest.metres, here.metres);
      widest.cells = std::max(widest.cells, here.cells);
    }
    if (widest.cells > 1)
      warnings.push_back(fmt::format(
          "body \"{}\": its triangles are up to {:.2g} cells wide where it touches, {:.3g} m, and meet at an angle: "
          "the pressure follows their edges; a finer surface is needed, not finer cells",
          state.bodies[b].spec->name, widest.cells, widest.metres));
  }
  return warnings;
}

}  // namespace cgcontact
