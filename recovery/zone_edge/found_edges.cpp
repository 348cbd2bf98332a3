#include "recovery/zone_edge/found_edges.hpp"

#include <algorithm>
#include <cmath>

#include "recovery/zone_edge/connected_sets.hpp"

namespace cgcontact {
namespace {

/// How far outside a zone that is fitted as a whole (recovery/zone_edge/narrow_edges.hpp) its edge is known, cells.
constexpr double outside_narrow = 2.5;

double largest_cell(const std::vector<EdgeSample>& samples) {
  double largest = 0;
  for (const EdgeSample& sample : samples) largest = std::max(largest, sample.cell_size);
  return largest;
}

}  // namespace

FoundEdges::FoundEdges(std::vector<EdgeSample> samples, const EdgeOptions& options)
    : options_(options), samples_(std::move(samples)), buckets_(reach() * largest_cell(samples_)) {
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    // All normals of a pair point the same way.
    const std::size_t first = first_of_pair_.try_emplace(samples_[i].pair, i).first->second;
    if (samples_[first].normal.dot(samples_[i].normal) < 0) samples_[i].normal *= -1;
    buckets_.add(samples_[i].origin, static_cast<int>(i));
  }
  number_zones();
}

void FoundEdges::number_zones() {
  zone_ = connected_sets(
      samples_.size(), reach() * largest_cell(samples_), [&](std::size_t i) { return samples_[i].origin; },
      [&](int i, int k) {
        const EdgeSample &a = samples_[i], &b = samples_[k];
        return a.pair == b.pair && !((a.origin - b.origin).norm() > reach() * std::max(a.cell_size, b.cell_size));
      });
  for (std::size_t i = 0; i < zone_.size(); ++i)  // in order of their first sample
    zone_[i] = zone_[i] == static_cast<int>(i) ? static_cast<int>(num_zones_++) : zone_[zone_[i]];
}

FoundEdges FoundEdges::without(const std::vector<char>& zones) const {
  std::vector<EdgeSample> kept;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (!zones[zone_[i]]) kept.push_back(samples_[i]);
  return FoundEdges(std::move(kept), options_);
}

int FoundEdges::zone(int pair, const Vec3& x) const {
  const EdgeSample* sample = nearest(pair, x);
  return sample ? zone_[sample - samples_.data()] : -1;
}

const EdgeSample* FoundEdges::nearest(int pair, const Vec3& x) const {
  const EdgeSample* found = nullptr;
  double least = 1e300;
  buckets_.each_near(x, [&](int i) {
    const EdgeSample& s = samples_[i];
    const double distance = (s.origin - x).norm();
    if (s.pair == pair && distance < least && distance < reach() * s.cell_size) found = &s, least = distance;
  });
  return found;
}

bool FoundEdges::near(int pair, const Vec3& x, EdgePiece& piece) const {
  if (samples_.empty()) return false;
  const EdgeSample* const first = nearest(pair, x);
  if (!first) return false;
  const double h = first->cell_size;
  // Farther outside there may be another zone, one without edges.
  if (first->narrow) return first->narrow->edge_near(x, first->origin, piece) && piece.inside(x) > -outside_narrow * h;
  Vec3 foot = first->origin;
  const auto each_weighted = [&](const auto& use) {
    buckets_.each_near(foot, [&](int i) {
      const EdgeSample& s = samples_[i];
      const double distance = (s.origin - foot).norm() / h;
      if (s.pair == pair && !s.narrow && distance < reach() &&
          s.closed.dot(first->closed) > 0)  // not the opposite edge
        use(s, std::exp(-0.5 * distance * distance / (options_.smoothing * options_.smoothing)));
    });
  };
  // Mean directions about the nearest sample; the foot of x on the edge.
  Vec3 closed = Vec3::Zero(), normal = Vec3::Zero();
  each_weighted([&](const EdgeSample& s, double w) {
    closed += w * s.closed;
    normal += w * s.normal;
  });
  normal.normalize();
  closed = (closed - closed.dot(normal) * normal).normalized();
  const Vec3 along = normal.cross(closed);
  foot += along.dot(x - foot) * along;
  // A parabola across over along.
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double sum = 0, height = 0, factor = 0, inverse_width = 0;
  each_weighted([&](const EdgeSample& s, double w) {
    const Vec3 d = (s.origin - foot) / h;
    const double t = along.dot(d);
    const Vec3 p(1, t, 0.5 * t * t);
    A += w * p * p.transpose();
    b += w * closed.dot(d) * p;
    sum += w;
    height += w * normal.dot(d);
    inverse_width += w * s.inverse_width;
    factor += w * s.factor;
  });
  const double ridge = first->in_strip ? 1e6 : std::pow(options_.place_scatter / options_.expected_slope, 2);
  A.diagonal() += Vec3(0, ridge, ridge);
  const Vec3 c = A.ldlt().solve(b);
  piece.origin = foot + h * (c[0] * closed + height / sum * normal);
  piece.closed = (closed - c[1] * along).normalized();
  piece.along = normal.cross(piece.closed);
  piece.curvature = -c[2] / h;
  piece.inverse_width = inverse_width / sum;
  piece.factor = factor / sum;
  piece.place_error = options_.expected_error * h;
  return true;
}

}  // namespace cgcontact
