#include "contact/model/opposite_points.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Cells: crossings nearer than this to the ends of a line of sight are those ends themselves (positions on curved
/// surfaces are rounded).
constexpr double end_tolerance = 1e-6;

/// Line in the grid coordinates of a body.
struct Line {
  Line(const BodyModel& body, const Vec3& x, const Vec3& n)
      : origin(body.cut_cells.grid.to_grid(x)), direction(body.cut_cells.grid.rotation.transpose() * n) {}
  Vec3 origin, direction;
};

bool any_within(const std::vector<Crossing>& crossings, double low, double high) {
  return std::any_of(crossings.begin(), crossings.end(), [=](const Crossing& c) { return c.t >= low && c.t <= high; });
}

/// Returns whether the body's boundary is crossed at x + t n with low <= t <= high (m, and less the tolerances of these
/// ends, cells).
bool is_crossed(const BodyModel& body, const Vec3& x, const Vec3& n, double low, double high, double low_tolerance,
                double high_tolerance) {
  const Line line(body, x, n);
  const double h = body.cut_cells.grid.cell_size;
  const double first = low / h + low_tolerance, last = high / h - high_tolerance;
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  body.cut_cells.solid.crossings(line.origin, line.direction, std::max(std::abs(first), std::abs(last)), crossings);
  return any_within(crossings, first, last);
}

/// Returns whether the other body lies between the point and its crossing at t (gap), or ends between them (overlap).
/// Its crossings up to the point itself count: coplanar faces of both bodies do not touch.
bool is_hidden(const std::vector<Crossing>& crossings, double t) {
  if (std::abs(t) <= end_tolerance) return false;
  return t > 0 ? any_within(crossings, -end_tolerance, t - end_tolerance)
               : any_within(crossings, t + end_tolerance, end_tolerance);
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
  solid.crossings(line.origin, line.direction, std::max(reach.ahead, reach.behind) / grid.cell_size + 2 * end_tolerance,
                  crossings);
  std::optional<OppositePoint> best;
  for (const Crossing& crossing : crossings) {
    if (crossing.t > reach.ahead / grid.cell_size || crossing.t < -reach.behind / grid.cell_size) continue;
    if (best && std::abs(crossing.t) >= std::abs(best->distance)) continue;
    if (crossing.normal.dot(line.direction) > -min_facing_cosine) continue;  // does not face this point
    if (is_hidden(crossings, crossing.t)) continue;
    const Vec3 y = line.origin + crossing.t * line.direction;
    if (!face.contains(solid.surfaces()[crossing.surface].names, grid.to_global(y), grid.rotation * crossing.normal))
      continue;
    // The cell on the inner side of the surface, also where the surface lies on a grid plane.
    const int cell = other.cut_cells.locate(y - inward_step * crossing.normal);
    if (cell >= 0) best = OppositePoint{crossing.t, cell, y, grid.rotation * crossing.normal};
  }
  if (!best) return best;
  best->distance *= grid.cell_size;
  const double d = best->distance;
  if (std::abs(d) <= end_tolerance * grid.cell_size) return best;
  // Own boundary: the point is on it; the opposite one may not be.
  if (d > 0 ? is_crossed(own, x, n, 0, d, end_tolerance, -end_tolerance)
            : is_crossed(own, x, n, d, 0, -end_tolerance, end_tolerance))
    return std::nullopt;
  return best;
}

bool comes_between(const BodyModel& body, const Vec3& x, const Vec3& n, double distance) {
  return distance > 0 && is_crossed(body, x, n, 0, distance, -end_tolerance, -end_tolerance);
}

double longest_extent(const BodyModel& body) {
  const auto [min, max] = box_around(body);
  Vec3 extent = max - min;
  if (body.spec->quadtree) extent[static_cast<int>(*body.spec->plane_strain)] = 0;  // any thickness
  return extent.maxCoeff();
}

double box_distance(const BodyModel& a, const BodyModel& b) {
  const auto [min_a, max_a] = box_around(a);
  const auto [min_b, max_b] = box_around(b);
  return (min_a - max_b).cwiseMax(min_b - max_a).cwiseMax(0).norm();
}

}  // namespace cgcontact
