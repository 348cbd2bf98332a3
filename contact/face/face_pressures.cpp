#include "contact/face/face_pressures.hpp"

#include <algorithm>
#include <cmath>

#include "recovery/face/zone_border.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {
namespace {

/// Cells around a patch whose squares say where the edge is.
constexpr double border_reach = 1.5;
/// Cells around the middle of a patch searched for an edge: more than half a patch and the term's reach.
constexpr double edge_reach = 6;

}  // namespace

std::optional<SolvedZone::ChartPoint> SolvedZone::chart_point(int body, const Vec3& x, const Vec3& normal) const {
  const double along = chart.normal(x).dot(normal) * (body == primary ? 1 : -1);
  if (along < same_side || std::abs(chart.height(x)) > 4 * h) return std::nullopt;
  const FaceGrid& grid = pressure.grid;
  FacePosition position = chart.coordinates(x);
  if (grid.plane_strain) position[0] = 0;
  const std::array<int, 2> at = grid.index_of(position);
  // A point at the end of a face lies at the border of the last patch.
  for (const int i : {0, -1, 1})
    for (const int j : {0, -1, 1}) {
      const int row = at[0] + i, column = at[1] + j;
      if (row < 0 || column < 0 || row >= grid.size[0] || column >= grid.size[1]) continue;
      const int patch = row * grid.size[1] + column;
      if (!known[patch]) continue;
      return ChartPoint{position, patch, body == primary ? along : cosine[patch]};
    }
  return std::nullopt;
}

std::optional<PressureOnFace> SolvedZone::at(int body, const Vec3& x, const Vec3& normal) const {
  const auto found = chart_point(body, x, normal);
  if (!found) return std::nullopt;
  return PressureOnFace{found->cosine * pressure.at(found->position), found->cosine * pressure.error[found->patch]};
}

std::optional<double> SolvedZone::square_at(int body, const Vec3& x, const Vec3& normal) const {
  const auto found = chart_point(body, x, normal);
  if (!found) return std::nullopt;
  return found->cosine * found->cosine * pressure.square_at(found->position);
}

std::vector<ZoneEdgeSegment> edge_of_zone(const SolvedZone& zone) {
  const FaceGrid& grid = zone.pressure.grid;
  const auto patch_at = [&](const FacePosition& position) {
    const std::array<int, 2> at = grid.index_of(position);
    return std::clamp(at[0], 0, grid.size[0] - 1) * grid.size[1] + std::clamp(at[1], 0, grid.size[1] - 1);
  };
  std::vector<ZoneEdgeSegment> edge;
  for (const BorderPoint& border : border_of_zone(grid, zone.pressure.square, zone.known, border_reach * zone.h)) {
    const int patch = patch_at(border.position);
    FacePosition slope = FacePosition::Zero();  // of the face's height
    for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a) {
      const auto [before, after] = grid.beside(patch, a);
      if (after < 0 || before < 0 || !zone.known[after] || !zone.known[before]) continue;
      slope[a] = (zone.height[after] - zone.height[before]) / (2 * grid.spacing[a]);
    }
    const Vec3 below = zone.chart.point(border.position), up = zone.chart.normal(below);
    const auto tangent = [&](const FacePosition& direction) {
      const double small = 1e-3 * zone.h;
      return Vec3((zone.chart.point(border.position + small * direction) - below) / small + slope.dot(direction) * up);
    };
    const Vec3 closed = tangent(border.inward), along = tangent({-border.inward[1], border.inward[0]});
    const double stretch = closed.norm(), cosine = zone.cosine[patch];
    ZoneEdgeSegment& segment = edge.emplace_back();
    segment.origin = below + (zone.height[patch] + slope.dot(border.position - grid.centre(patch))) * up;
    segment.closed = closed / stretch;
    segment.along = (along - along.dot(segment.closed) * segment.closed).normalized();
    segment.curvature = border.curvature * stretch / along.squaredNorm();
    segment.inverse_width = border.inverse_width / stretch;
    segment.factor = cosine * std::sqrt(border.slope / stretch);
  }
  return edge;
}

void FacePressures::add(SolvedZone zone) {
  PointBuckets& points = edges_.emplace_back(edge_reach * zone.h);
  for (std::size_t i = 0; i < zone.edge.size(); ++i) points.add(zone.edge[i].origin, static_cast<int>(i));
  zones.push_back(std::move(zone));
}

std::optional<double> FacePressures::square(int pair, int body, const Vec3& x, const Vec3& n) const {
  std::optional<double> found;
  for (const SolvedZone& zone : zones)
    if (zone.pair == pair) found = std::max(found, zone.square_at(body, x, n));
  return found;
}

bool FacePressures::has_zone(int pair) const {
  return std::any_of(zones.begin(), zones.end(), [&](const SolvedZone& zone) { return zone.pair == pair; });
}

bool FacePressures::edge_near(int pair, const Vec3& x, ZoneEdgeSegment& segment) const {
  double least = 1e300;
  for (std::size_t z = 0; z < zones.size(); ++z) {
    if (zones[z].pair != pair) continue;
    edges_[z].each_near(x, [&](int i) {
      const double distance = (zones[z].edge[i].origin - x).norm();
      if (distance < least && distance < edge_reach * zones[z].h) least = distance, segment = zones[z].edge[i];
    });
  }
  return least < 1e300;
}

std::optional<PressureOnFace> FacePressures::at(int pair, int body, const Vec3& x, const Vec3& normal) const {
  std::optional<PressureOnFace> found;
  for (const SolvedZone& zone : zones)
    if (zone.pair == pair) found = std::max(found, zone.at(body, x, normal));
  return found;
}

}  // namespace cgcontact
