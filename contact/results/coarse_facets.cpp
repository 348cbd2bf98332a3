#include "contact/results/coarse_facets.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/triangles/triangle_edges.hpp"

namespace cgcontact {
namespace {

/// Radians between neighbours of one smooth patch that make it curved.
constexpr double curved = 0.01;

/// Twice the area over the length of the edge from corner k: how far the triangle reaches from it.
double width(const TriangleSurface& surface, int triangle, int k) {
  const Vec3 &a = surface.corner(triangle, k), &b = surface.corner(triangle, (k + 1) % 3),
             &c = surface.corner(triangle, (k + 2) % 3);
  return (b - a).cross(c - a).norm() / (b - a).norm();
}

/// Width of the narrower one of two triangles that meet at an angle, the widest of such pairs at a triangle; 0: none.
/// In units of the surface's points, cells.
double facet_width(const TriangleSurface& surface, const std::vector<std::array<int, 3>>& neighbours, int triangle) {
  double widest = 0;
  for (int k = 0; k < 3; ++k) {
    const int other = neighbours[triangle][k];
    if (other < 0 || surface.patch(other) != surface.patch(triangle)) continue;
    if (surface.normal(triangle).dot(surface.normal(other)) > std::cos(curved)) continue;
    int edge = 0;
    while (edge < 2 && neighbours[other][edge] != triangle) ++edge;
    widest = std::max(widest, std::min(width(surface, triangle, k), width(surface, other, edge)));
  }
  return widest;
}

}  // namespace

std::vector<std::string> coarse_facet_warnings(const SolvedState& state) {
  std::vector<std::string> warnings;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    const BodyModel& body = state.bodies[b];
    const TriangleSurface* const surface = body.cut_cells.solid.triangles();
    if (!surface) continue;
    const auto neighbours = edge_neighbours(surface->triangles(), surface->points().size());
    double widest = 0;
    for (const ContactPair& pair : state.pairs) {
      if (pair.primary != b && pair.secondary != b) continue;
      for (const ContactPoint& q : pair.points)
        if (q.active)
          widest = std::max(
              widest,
              facet_width(*surface, neighbours,
                          surface->nearest(pair.primary == b ? q.primary_position : q.secondary_position).triangle));
    }
    if (widest > 1)
      warnings.push_back(fmt::format(
          "body \"{}\": its triangles are up to {:.2g} cells wide where it touches, {:.3g} m, and meet at an angle: "
          "the pressure follows their edges; a finer surface is needed, not finer cells",
          body.spec->name, widest, widest * body.cut_cells.grid.cell_size));
  }
  return warnings;
}

}  // namespace cgcontact
