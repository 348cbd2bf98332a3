#include "recovery/zone_edge/edge_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "recovery/patch/tangents.hpp"
#include "recovery/zone_edge/narrow_edges.hpp"

namespace cgcontact {
namespace {

/// Places per chunk of the parallel loops.
constexpr std::size_t grain = 4;

/// Samples are equally far from a place if they are so up to that part: then the first one counts, in mirror images
/// too.
constexpr double nearer = 1 - 1e-9;

/// Cells around a place whose points say where the edge may be.
constexpr double guess_reach = 2;

/// A strip of the face (a slab of few cells, a narrow land): points within the reach of the sums spread less than that
/// across it, cells squared (of a strip of three and a half cells; of the end and the corner of a wide face: 1.7
/// and 1.2).
constexpr double strip_variance = 1;

/// Direction across the strip that the face is around x; false: it is none. One row of cells more on one side of a
/// strip would turn the line that parts the points by 45 degrees and more.
bool is_strip(const std::vector<const TransmittedForce*>& points, double cell_size, Vec3& across) {
  double area = 0;
  Vec3 mean = Vec3::Zero();
  Mat3 square = Mat3::Zero();
  for (const TransmittedForce* f : points) {
    const Vec3 d = (f->position - points.front()->position) / cell_size;
    area += f->area;
    mean += f->area * d;
    square += f->area * d * d.transpose();
  }
  if (!(area > 0)) return false;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(square / area - mean / area * (mean / area).transpose());
  across = eigen.eigenvectors().col(1);  // the smallest one is along the normal
  return eigen.eigenvalues()[1] < strip_variance;
}

/// The line that parts the closed from the open points around x best: least squares of +1 and -1 by a
/// linear function on the face, both sorts counting alike; in a strip a line across it. False if there is only one
/// sort.
bool part_points(const ContactZone& zone, const Vec3& x, const Vec3& n, const EdgeOptions& options,
                 EdgeSample& sample) {
  const double h = sample.cell_size;
  const auto points = zone.forces_near(sample.pair, x, n, guess_reach * h);
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
  const auto part = [&](const Vec3& t1, const Vec3& t2, double held) {
    const auto tangential = [&](const TransmittedForce& f) {
      return Vec3(1, t1.dot(f.position - centroid) / h, t2.dot(f.position - centroid) / h);
    };
    Mat3 A = Mat3::Zero();
    Vec3 b = Vec3::Zero();
    for (const TransmittedForce* f : points) {
      const Vec3 p = tangential(*f);
      A += weight(*f) * p * p.transpose();
      b += weight(*f) * (f->closed ? 1 : -1) * p;
    }
    A.diagonal() += Vec3(0, 1e-6, held);  // points on one line
    const Vec3 c = A.ldlt().solve(b);
    const double steep = c.tail<2>().norm();
    if (!(steep > 0)) return false;
    sample.closed = (c[1] * t1 + c[2] * t2) / steep;
    sample.origin = centroid - c[0] / steep * h * sample.closed;
    sample.normal = normal;
    return true;
  };
  Vec3 across;
  if (is_strip(zone.forces_near(sample.pair, x, n, options.reach_of_sums() * h), h, across)) {
    across = (across - across.dot(normal) * normal).normalized();
    if ((sample.in_strip = part(normal.cross(across), across, 1e6))) return true;
  }
  const auto [t1, t2] = tangents(normal);
  return part(t1, t2, 1e-6);
}

/// First guess from around a closed point, then from around that.
bool guess_edge(const ContactZone& zone, const TransmittedForce& closed, const EdgeOptions& options,
                EdgeSample& sample) {
  sample.pair = closed.pair;
  sample.cell_size = closed.cell_size;
  return part_points(zone, closed.position, closed.normal, options, sample) &&
         part_points(zone, Vec3(sample.origin), Vec3(sample.normal), options, sample);
}

/// Across the zone from a sample to its other side, over the points within a cell along the edge: to the opposite edge
/// where open points follow, else to a plane of symmetry (or an edge of the body) that the zone is taken to go on
/// behind (mean and variance of the distances of closed points). A zone with both edges has the width that its forces
/// spread over, four standard deviations under Hertz's contact.
double inverse_width_at(const ContactZone& zone, const EdgeSample& sample) {
  const double h = sample.cell_size;
  struct PointInBand {
    double across, area, force;
    bool closed;
  };
  std::vector<PointInBand> band;
  for (const TransmittedForce& f : zone.forces()) {
    const Vec3 d = f.position - sample.origin;
    const double across = sample.closed.dot(d);
    if (f.pair == sample.pair && d.squaredNorm() - across * across < h * h)
      band.push_back({across, f.area, f.spread_force, f.closed});
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
  const auto spread = [&](auto weight) {
    double sum = 0, mean = 0, square = 0;
    for (const PointInBand& p : band) {
      if (!p.closed || p.across > gap + h) continue;
      sum += weight(p);
      mean += weight(p) * p.across;
      square += weight(p) * p.across * p.across;
    }
    mean /= sum;
    return std::pair(mean, std::sqrt(std::max(square / sum - mean * mean, 0.0)));
  };
  const auto [mean, deviation] = spread([](const PointInBand& p) { return p.area; });
  const double closed = mean + std::sqrt(3.0) * deviation;
  if (!(closed > h)) return 0;
  if (!has_opposite) return 1 / (2 * closed);
  // A group's force is spread over a cell.
  const double by_forces = spread([](const PointInBand& p) { return p.force; }).second;
  return 1 / std::max(4 * std::sqrt(std::max(by_forces * by_forces - h * h / 12, 0.0)), h);
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
      if (samples[k].pair != samples[i].pair || distance >= nearer * nearest) continue;
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
void place_edges(const ContactZone& zone, const Scales& scales, const EdgeOptions& options,
                 std::vector<EdgeSample>& samples) {
  const FoundEdges edges(samples, options);
  parallel_for("cgcontact::edge_search::samples", samples.size(), grain, [&](std::size_t i) {
    EdgeSample& sample = samples[i];
    const double h = sample.cell_size;
    EdgePiece piece;
    edges.near(sample.pair, sample.origin, piece);
    const EdgeFit fit = fit_edge(
        piece, zone.forces_near(sample.pair, piece.origin, sample.normal, options.reach_of_sums() * h), h, options);
    if (!fit.found) {
      sample.pair = -1;
      return;
    }
    sample.origin = piece.origin - fit.shift * h * piece.closed;
    sample.closed = piece.closed;
    sample.factor = -fit.strength / scales.stress;
  });
  keep_found(samples);
}

}  // namespace

FoundEdges find_contact_edges(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                              const RecoveryOptions& options) {
  std::vector<EdgeSample> all;
  for (std::size_t b = 0; b < bodies.size() && options.contact_edge; ++b) {
    const ContactZone zone(bodies, b, options.edge);
    const auto closed = zone.closed_cells();
    PointBuckets open(guess_reach * zone.largest_cell());
    for (std::size_t i = 0; i < zone.forces().size(); ++i)
      if (!zone.forces()[i].closed) open.add(zone.forces()[i].position, static_cast<int>(i));
    std::vector<EdgeSample> samples(closed.size());
    parallel_for("cgcontact::edge_search::closed_points", closed.size(), grain, [&](std::size_t i) {
      samples[i].cell = static_cast<int>(i);
      bool inner = true;
      open.each_near(closed[i].position, [&](int) { inner = false; });
      if (inner || closed[i].image || !guess_edge(zone, closed[i], options.edge, samples[i])) samples[i].pair = -1;
    });
    keep_found(samples);
    measure_widths(zone, samples);
    const std::vector<EdgeSample> narrow = take_narrow_edges(zone, closed, scales.stress, options.edge, samples);
    for (int round = 0; round < options.edge.rounds && !samples.empty(); ++round) {
      if (round > 0) measure_widths(zone, samples);
      place_edges(zone, scales, options.edge, samples);
    }
    samples.insert(samples.end(), narrow.begin(), narrow.end());
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return FoundEdges(std::move(all), options.edge);
}

}  // namespace cgcontact
