#include "contact/opposite_points.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Cells, from a surface into the body: less than the thinnest cells that are kept, more than rounding of positions.
constexpr double inward_step = 1e-12;
/// Cells: crossings nearer than this to the ends of a line of sight are those ends themselves (positions on curved
/// surfaces are rounded).
constexpr double end_tolerance = 1e-6;

/// A line in the grid coordinates of a body.
struct Line {
  Line(const BodyModel& body, const Vec3& x, const Vec3& n)
      : origin(body.cut_cells.grid.to_grid(x)), direction(body.cut_cells.grid.rotation.transpose() * n) {}
  Vec3 origin, direction;
};

/// Does any crossing lie between 0 and t, both excluded?
bool any_between(const std::vector<Crossing>& crossings, double t) {
  return std::any_of(crossings.begin(), crossings.end(), [t](const Crossing& c) {
    return t > 0 ? c.t > end_tolerance && c.t < t - end_tolerance : c.t < -end_tolerance && c.t > t + end_tolerance;
  });
}

/// Is the body's boundary crossed between x and x + distance n (m)?
bool is_crossed(const BodyModel& body, const Vec3& x, const Vec3& n, double distance) {
  const Line line(body, x, n);
  const double t = distance / body.cut_cells.grid.cell_size;
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  body.cut_cells.solid.crossings(line.origin, line.direction, std::abs(t), crossings);
  return any_between(crossings, t);
}

std::pair<Vec3, Vec3> box_around(const BodyModel& body) {
  Vec3 min, max;
  body.spec->solid.bounding_box(min, max);
  return {min, max};
}

}  // namespace

std::optional<OppositePoint> find_opposite(const BodyModel& own, const BodyModel& other, const FaceSpec& face,
                                           const Vec3& x, const Vec3& n, const Reach& reach) {
  const Grid& grid = other.cut_cells.grid;
  const Solid& solid = other.cut_cells.solid;
  const Line line(other, x, n);
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  solid.crossings(line.origin, line.direction, std::max(reach.ahead, reach.behind) / grid.cell_size, crossings);
  std::optional<OppositePoint> best;
  for (const Crossing& crossing : crossings) {
    if (crossing.t > reach.ahead / grid.cell_size || crossing.t < -reach.behind / grid.cell_size) continue;
    if (best && std::abs(crossing.t) >= std::abs(best->distance)) continue;
    if (crossing.normal.dot(line.direction) > -0.1) continue;  // does not face this point
    if (any_between(crossings, crossing.t)) continue;
    const Vec3 y = line.origin + crossing.t * line.direction;
    if (!face.contains(solid.surfaces()[crossing.surface].names, grid.to_global(y), grid.rotation * crossing.normal))
      continue;
    // The cell on the inner side of the surface, also where the surface lies on a grid plane.
    const int cell = other.cut_cells.locate(y - inward_step * crossing.normal);
    if (cell >= 0) best = OppositePoint{crossing.t, cell, y};
  }
  if (!best) return best;
  best->distance *= grid.cell_size;
  if (is_crossed(own, x, n, best->distance)) return std::nullopt;
  return best;
}

bool comes_between(const BodyModel& body, const Vec3& x, const Vec3& n, double distance) {
  return distance > 0 && is_crossed(body, x, n, distance);
}

double longest_extent(const BodyModel& body) {
  const auto [min, max] = box_around(body);
  return (max - min).maxCoeff();
}

double box_distance(const BodyModel& a, const BodyModel& b) {
  const auto [min_a, max_a] = box_around(a);
  const auto [min_b, max_b] = box_around(b);
  return (min_a - max_b).cwiseMax(min_b - max_a).cwiseMax(0).norm();
}

}  // namespace cgcontact
