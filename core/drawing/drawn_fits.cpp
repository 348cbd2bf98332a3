#include "core/drawing/drawn_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/numbers/point_buckets.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {

namespace {

/// Fraction of the scene's diagonal below which gaps are not seen.
constexpr double invisible = 1e-3;
/// Fraction of a body's second shortest extent within which its share falls to zero; the shortest may be that of a
/// slice.
constexpr double reach_fraction = 0.25;
/// Fraction of the reach: the cubes in which closed points are gathered.
constexpr double cube_fraction = 0.2;

struct Extent {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  void add(const DrawnBody& body) {
    for (const Vec3& x : body.position) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  }
  Vec3 sides() const { return high - low; }
};

/// Closed contact of one body and pair: points with outward normals.
struct ClosedFace {
  std::vector<Vec3> position, normal;
};

ClosedFace closed_face(const Results& results, int body, int pair, double cube) {
  struct Sum {
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
    double area = 0;
  };
  std::map<std::array<long long, 3>, Sum> cubes;
  for (const ContactRow& row : results.contact_rows) {
    if (row.body != body || row.pair != pair || !row.active) continue;
    std::array<long long, 3> key;
    for (int k = 0; k < 3; ++k) key[k] = static_cast<long long>(std::floor(row.x[k] / cube));
    Sum& sum = cubes[key];
    sum.position += row.weight * row.x;
    sum.normal += row.weight * row.normal;
    sum.area += row.weight;
  }
  ClosedFace face;
  for (const auto& [key, sum] : cubes) {
    if (!(sum.area > 0) || !(sum.normal.norm() > 0.1 * sum.area)) continue;
    face.position.push_back(sum.position / sum.area);
    face.normal.push_back(sum.normal.normalized());
  }
  return face;
}

/// Returns the distance at which closed faces of a pair are drawn (positive: apart) by exaggerated displacements, m.
double drawn_gap(const Results& results, int pair, double exaggeration) {
  double sum = 0, area = 0;
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != pair || !row.active || !std::isfinite(row.gap)) continue;
    const double moved_apart = row.gap - row.distance + results.pairs[pair].interference;
    sum += row.weight * (row.distance + exaggeration * moved_apart);
    area += row.weight;
  }
  return area > 0 ? sum / area : 0;
}

void close_gap(const ClosedFace& face, double share, double reach, double exaggeration, DrawnBody& body) {
  PointBuckets buckets(reach);
  for (std::size_t k = 0; k < face.position.size(); ++k) buckets.add(face.position[k], static_cast<int>(k));
  const double width = 0.5 * cube_fraction * reach;
  parallel_for("cgcontact::drawn_fits::closed_gaps", body.position.size(), 512, [&](std::size_t p) {
    double nearest = reach, total = 0;
    Vec3 normal = Vec3::Zero();
    buckets.each_near(body.position[p],
                      [&](int k) { nearest = std::min(nearest, (face.position[k] - body.position[p]).norm()); });
    if (nearest >= reach) return;
    buckets.each_near(body.position[p], [&](int k) {
      const double distance = (face.position[k] - body.position[p]).norm() - nearest;
      const double weight = std::exp(-0.5 * distance * distance / (width * width));
      normal += weight * face.normal[k];
      total += weight;
    });
    const double fall = 1 - std::max(0.0, nearest - cube_fraction * reach) / (reach * (1 - cube_fraction));
    if (total > 0 && normal.norm() > 0) body.displacement[p] += share / exaggeration * fall * normal.normalized();
  });
}

}  // namespace

void draw_fits_closed(const Results& results, double exaggeration, std::vector<DrawnBody>& bodies) {
  Extent scene;
  for (const DrawnBody& body : bodies) scene.add(body);
  for (int pair = 0; pair < static_cast<int>(results.pairs.size()); ++pair) {
    const double gap = drawn_gap(results, pair, exaggeration);
    if (!(std::abs(gap) > invisible * scene.sides().norm())) continue;
    for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
      if (bodies[b].displacement.empty()) continue;
      Extent extent;
      extent.add(bodies[b]);
      Vec3 sides = extent.sides();
      std::sort(sides.begin(), sides.end());
      const double reach = reach_fraction * sides[1];
      const ClosedFace face = closed_face(results, b, pair, cube_fraction * reach);
      if (!face.position.empty()) close_gap(face, gap / 2, reach, exaggeration, bodies[b]);
    }
  }
}

}  // namespace cgcontact
