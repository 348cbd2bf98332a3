#include "recovery/edge_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "recovery/narrow_edges.hpp"

namespace cgcontact {
namespace {

/// Places per chunk of the parallel loops.
constexpr std::size_t grain = 4;

/// Times that all places are looked for: from the border of the closed points the second time is within 0.01 cells.
constexpr int rounds = 3;

/// Samples count with exp(-(distance / (smoothing width))^2 / 2), and not at all beyond reach widths.
constexpr double smoothing = 1.5, reach = 4 * smoothing;
/// What the place of an edge may be off, cells; the scatter below is that of its places.
constexpr double expected_error = 0.015;
/// How far outside a zone that is fitted as a whole (recovery/narrow_edges.hpp) its edge is known, widths.
constexpr double outside_narrow = 2.5;
/// Scatter of the first guesses and of the places that the forces give, and what slope and curvature against the mean
/// direction are expected to be; cells.
constexpr double guess_scatter = 0.2, place_scatter = 0.02, expected_slope = 0.2;

/// Cells around a place whose points say where the edge may be.
constexpr double guess_reach = 2;

/// The line that parts the closed from the open points around x best: least squares of +1 and -1 by a
/// linear function on the face, both sorts counting alike. False if there is only one sort or no line parts them.
bool part_points(const ContactZone& zone, const Vec3& x, const Vec3& n, EdgeSample& sample) {
  const double h = zone.cell_size();
  const auto points = zone.forces_near(sample.pair, x, n, guess_reach);
  double area[2] = {};  // open, closed
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  for (const TransmittedForce* f : points) area[f->closed] += f->area;
  if (area[0] == 0 || area[1] == 0) return false;
  const auto weight = [&](const TransmittedForce& f) { return 0.5 * f.area / area[f.closed]; };
  for (const TransmittedForce* f : points) {
    centroid += weight(*f) * f->position;
    normal += weight(*f) * f->normal;
  }
  normal.normalize();
  const auto [t1, t2] = tangents(normal);
  const auto tangential = [&, &e1 = t1, &e2 = t2](const TransmittedForce& f) {
    return Vec3(1, e1.dot(f.position - centroid) / h, e2.dot(f.position - centroid) / h);
  };
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (const TransmittedForce* f : points) {
    const Vec3 p = tangential(*f);
    A += weight(*f) * p * p.transpose();
    b += weight(*f) * (f->closed ? 1 : -1) * p;
  }
  A.diagonal().tail<2>().array() += 1e-6;  // points on one line
  const Vec3 c = A.ldlt().solve(b);
  const double steep = c.tail<2>().norm();
  if (!(steep > 0.05)) return false;
  double wrong = 0;
  for (const TransmittedForce* f : points)
    if (f->closed != (c.dot(tangential(*f)) > 0)) wrong += weight(*f);
  sample.closed = (c[1] * t1 + c[2] * t2) / steep;
  sample.origin = centroid - c[0] / steep * h * sample.closed;
  sample.normal = normal;
  return wrong < 0.2;
}

/// First guess from around a closed point, then from around that.
bool guess_edge(const ContactZone& zone, const TransmittedForce& closed, EdgeSample& sample) {
  sample.pair = closed.pair;
  return part_points(zone, closed.position, closed.normal, sample) &&
         part_points(zone, Vec3(sample.origin), Vec3(sample.normal), sample);
}

/// Across the zone from a sample to its other side, over the points within a cell along the edge: to the opposite edge
/// where open points follow, else to a plane of symmetry (or an edge of the body) that the zone is taken to go on
/// behind. The mean and variance of the distances give the side without regard to how the points lie.
double inverse_width_at(const ContactZone& zone, const EdgeSample& sample) {
  const double h = zone.cell_size();
  struct PointInBand {
    double across, area;
    bool closed;
  };
  std::vector<PointInBand> band;
  for (const TransmittedForce& f : zone.forces()) {
    const Vec3 d = f.position - sample.origin;
    const double across = sample.closed.dot(d);
    if (f.pair == sample.pair && d.squaredNorm() - across * across < h * h) band.push_back({across, f.area, f.closed});
  }
  // Open points behind the zone: more open than closed area in a strip of one cell. Single points inside may be open.
  std::vector<double> surplus;
  for (const PointInBand& p : band) {
    if (p.across < h) continue;
    const auto strip = static_cast<std::size_t>(p.across / h);
    if (strip >= surplus.size()) surplus.resize(strip + 1, 0.0);
    surplus[strip] += p.closed ? -p.area : p.area;
  }
  const auto first_open = std::find_if(surplus.begin(), surplus.end(), [](double open) { return open > 0; });
  const bool has_opposite = first_open != surplus.end();
  const double gap = has_opposite ? h * static_cast<double>(first_open - surplus.begin()) : 1e300;
  double area = 0, mean = 0, square = 0;
  for (const PointInBand& p : band) {
    if (!p.closed || p.across > gap + h) continue;
    area += p.area;
    mean += p.area * p.across;
    square += p.area * p.across * p.across;
  }
  if (area == 0) return 0;
  mean /= area;
  const double closed = mean + std::sqrt(3 * std::max(square / area - mean * mean, 0.0));
  return closed > h ? 1 / (has_opposite ? closed : 2 * closed) : 0;
}

/// Some samples are measured, the others take the value of the nearest of these.
void measure_widths(const ContactZone& zone, std::vector<EdgeSample>& samples) {
  constexpr std::size_t measured = 24;
  const std::size_t stride = samples.size() / measured + 1;
  parallel_for("cgcontact::edge_search::widths", (samples.size() + stride - 1) / stride, 1,
               [&](std::size_t i) { samples[i * stride].inverse_width = inverse_width_at(zone, samples[i * stride]); });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % stride == 0) continue;
    double nearest = 1e300;
    for (std::size_t k = 0; k < samples.size(); k += stride) {
      const double distance = (samples[k].origin - samples[i].origin).squaredNorm();
      if (samples[k].pair != samples[i].pair || distance >= nearest) continue;
      nearest = distance;
      samples[i].inverse_width = samples[k].inverse_width;
    }
  }
}

void keep_found(std::vector<EdgeSample>& samples) {
  samples.erase(std::remove_if(samples.begin(), samples.end(), [](const EdgeSample& s) { return s.pair < 0; }),
                samples.end());
}

/// Moves all samples to where the forces put the edge; those without such a place are dropped.
void place_edges(const ContactZone& zone, const Scales& scales, double scatter, std::vector<EdgeSample>& samples) {
  const FoundEdges edges(samples, zone.cell_size(), scatter);
  parallel_for("cgcontact::edge_search::samples", samples.size(), grain, [&](std::size_t i) {
    EdgeSample& sample = samples[i];
    EdgePiece piece;
    edges.near(sample.pair, sample.origin, piece);
    const EdgeFit fit =
        fit_edge(piece, zone.forces_near(sample.pair, piece.origin, sample.normal, edge_fit_reach), zone.cell_size());
    if (!fit.found) {
      sample.pair = -1;
      return;
    }
    sample.origin = piece.origin - fit.shift * zone.cell_size() * piece.closed;
    sample.closed = piece.closed;
    sample.factor = -fit.strength / scales.stress;
  });
  keep_found(samples);
}

}  // namespace

FoundEdges::FoundEdges(std::vector<EdgeSample> samples, double width, double scatter)
    : samples_(std::move(samples)),
      width_(width),
      ridge_(std::pow(scatter / expected_slope, 2)),
      buckets_(reach * width) {
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    // All normals of a pair point the same way.
    const std::size_t first = first_of_pair_.try_emplace(samples_[i].pair, i).first->second;
    if (samples_[first].normal.dot(samples_[i].normal) < 0) samples_[i].normal *= -1;
    buckets_.add(samples_[i].origin, static_cast<int>(i));
  }
}

bool FoundEdges::near(int pair, const Vec3& x, EdgePiece& piece) const {
  if (samples_.empty()) return false;
  const EdgeSample* first = nullptr;
  double nearest = reach * width_;
  buckets_.each_near(x, [&](int i) {
    const EdgeSample& s = samples_[i];
    const double distance = (s.origin - x).norm();
    if (s.pair == pair && distance < nearest) first = &s, nearest = distance;
  });
  if (!first) return false;
  // Farther outside there may be another zone, one without edges.
  if (first->narrow)
    return first->narrow->edge_near(x, first->origin, piece) && piece.inside(x) > -outside_narrow * width_;
  Vec3 foot = first->origin;
  const auto each_weighted = [&](const auto& use) {
    buckets_.each_near(foot, [&](int i) {
      const EdgeSample& s = samples_[i];
      const double distance = (s.origin - foot).norm() / width_;
      if (s.pair == pair && !s.narrow && distance < reach)
        use(s, std::exp(-0.5 * distance * distance / (smoothing * smoothing)));
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
    const Vec3 d = (s.origin - foot) / width_;
    const double t = along.dot(d);
    const Vec3 p(1, t, 0.5 * t * t);
    A += w * p * p.transpose();
    b += w * closed.dot(d) * p;
    sum += w;
    height += w * normal.dot(d);
    inverse_width += w * s.inverse_width;
    factor += w * s.factor;
  });
  A(1, 1) += ridge_;
  A(2, 2) += ridge_;
  const Vec3 c = A.ldlt().solve(b);
  piece.origin = foot + width_ * (c[0] * closed + height / sum * normal);
  piece.closed = (closed - c[1] * along).normalized();
  piece.along = normal.cross(piece.closed);
  piece.curvature = -c[2] / width_;
  piece.inverse_width = inverse_width / sum;
  piece.factor = factor / sum;
  piece.place_error = expected_error * width_;
  return true;
}

FoundEdges find_contact_edges(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                              const RecoveryOptions& options) {
  std::vector<EdgeSample> all;
  double width = 0;
  for (std::size_t b = 0; b < bodies.size() && options.contact_edge; ++b) {
    const ContactZone zone(bodies, b);
    const auto closed = zone.closed_cells();
    PointBuckets open(guess_reach * zone.cell_size());
    for (std::size_t i = 0; i < zone.forces().size(); ++i)
      if (!zone.forces()[i].closed) open.add(zone.forces()[i].position, static_cast<int>(i));
    std::vector<EdgeSample> samples(closed.size());
    parallel_for("cgcontact::edge_search::closed_points", closed.size(), grain, [&](std::size_t i) {
      samples[i].cell = static_cast<int>(i);
      bool inner = true;
      open.each_near(closed[i].position, [&](int) { inner = false; });
      if (inner || closed[i].image || !guess_edge(zone, closed[i], samples[i])) samples[i].pair = -1;
    });
    keep_found(samples);
    measure_widths(zone, samples);
    const std::vector<EdgeSample> narrow = take_narrow_edges(zone, closed, scales.stress, samples);
    for (int round = 0; round < rounds && !samples.empty(); ++round) {
      if (round > 0) measure_widths(zone, samples);
      place_edges(zone, scales, round == 0 ? guess_scatter : place_scatter, samples);
    }
    samples.insert(samples.end(), narrow.begin(), narrow.end());
    if (!samples.empty()) width = std::max(width, zone.cell_size());
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return FoundEdges(std::move(all), width, place_scatter);
}

}  // namespace cgcontact
