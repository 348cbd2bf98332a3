#include "contact/adaptive/singular_causes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cgcontact {
namespace {

/// Cosine of the angle between the normals of two faces from which on they make an edge: 20 degrees, more than any two
/// triangles of one smooth patch have.
constexpr double edge_cosine = 0.94;
/// Cosine between the normals of a plane of symmetry and of a free face from which on the mirrored body has a
/// re-entrant edge there: 5 degrees beyond a right angle.
constexpr double mirrored_edge = 0.09;
/// Part of the radius by which one point must lie before the plane of another one to make a re-entrant edge with it.
constexpr double before_plane = 0.02;
/// Cosine with the normal from which on a held direction is the normal.
constexpr double along_normal = 0.99;
/// Cells of the opposite body within which its edges are looked for: it has a few points in each of them.
constexpr double opposite_cells = 1.5;

/// A point of a boundary with what acts there.
struct EdgePoint {
  Vec3 x, normal;
  int surface = 0, pair = -1;
  bool held = false, clamped = false;  ///< along the normal alone; in other directions too
};

std::vector<EdgePoint> points_near(const SolvedState& state, int b, const Vec3& x, double radius) {
  const BodyModel& body = state.bodies[b];
  std::vector<std::pair<int, BodyFace>> supports;
  for (int s = 0; s < static_cast<int>(state.scene.supports.size()); ++s)
    if (state.scene.supports[s].face.body == b)
      supports.emplace_back(s, BodyFace(state.scene.supports[s].face.face, body));
  std::vector<EdgePoint> points;
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
    EdgePoint point;
    point.x = body.point(p);
    if ((point.x - x).norm() > radius) continue;
    point.normal = body.normal(p);
    point.surface = body.cut_cells.boundary.surface[p];
    point.pair = body.boundary.pair_of_point[p];
    for (const auto& [support, face] : supports) {
      if (!face.contains(p)) continue;
      for (const HeldDirection& h : held_at(state.scene, body, support, point.x, point.normal)) {
        if (h.stiffness > 0) continue;
        point.held = true;
        point.clamped = point.clamped || std::abs(h.direction.dot(point.normal)) < along_normal;
      }
    }
    points.push_back(point);
  }
  return points;
}

/// Do two points of different faces lie before each other's plane, at an angle?
bool is_reentrant(const EdgePoint& a, const EdgePoint& b, double radius) {
  return a.surface != b.surface && a.normal.dot(b.normal) < edge_cosine &&
         (b.x - a.x).dot(a.normal) > before_plane * radius && (a.x - b.x).dot(b.normal) > before_plane * radius;
}

/// What is held changes between the points: the end of a clamp; the end of a support within a face, or at a face that
/// a plane of symmetry does not meet at right angles.
bool is_end_of_support(const EdgePoint& a, const EdgePoint& b) {
  if (a.clamped != b.clamped) return true;
  return a.held != b.held && a.normal.dot(b.normal) > mirrored_edge;
}

bool is_bonded(const SolvedState& state, const EdgePoint& point) {
  return point.pair >= 0 && state.pairs[point.pair].bonded();
}

/// An edge of the body with its mirror images: none where a free face meets a plane of symmetry at right angles.
bool is_edge(const EdgePoint& a, const EdgePoint& b) {
  const double cosine = a.normal.dot(b.normal);
  return a.surface != b.surface && cosine < edge_cosine && (a.held == b.held || std::abs(cosine) > mirrored_edge);
}

/// Has the body an edge within so many of its cells or within the radius?
bool has_edge_near(const SolvedState& state, int b, const Vec3& x, double radius) {
  const BodyModel& body = state.bodies[b];
  double nearest = std::numeric_limits<double>::infinity(), cell = 0;
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p)
    if (const double d = (body.point(p) - x).norm(); d < nearest) {
      nearest = d;
      cell = body.cut_cells.h(body.cut_cells.boundary.cell[p]);
    }
  const std::vector<EdgePoint> points = points_near(state, b, x, std::max(radius, opposite_cells * cell));
  return std::any_of(points.begin(), points.end(), [&](const EdgePoint& a) {
    return std::any_of(points.begin(), points.end(), [&](const EdgePoint& other) { return is_edge(a, other); });
  });
}

}  // namespace

bool has_cause_of_singularity(const SolvedState& state, int body, const Vec3& x, double radius) {
  const std::vector<EdgePoint> points = points_near(state, body, x, radius);
  for (const EdgePoint& a : points)
    for (const EdgePoint& b : points)
      if (is_reentrant(a, b, radius) || is_end_of_support(a, b) || is_bonded(state, a) != is_bonded(state, b))
        return true;
  std::vector<int> seen;
  for (const EdgePoint& point : points) {
    if (point.pair < 0 || std::find(seen.begin(), seen.end(), point.pair) != seen.end()) continue;
    seen.push_back(point.pair);
    const ContactPair& pair = state.pairs[point.pair];
    if (has_edge_near(state, pair.primary, x, radius) || has_edge_near(state, pair.secondary, x, radius)) return true;
  }
  return false;
}

}  // namespace cgcontact
