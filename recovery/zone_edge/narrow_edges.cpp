#include "recovery/zone_edge/narrow_edges.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/parallel.hpp"
#include "recovery/zone_edge/connected_sets.hpp"

namespace cgcontact {
namespace {

/// Closed cells are of one zone if their closed parts' centres are nearer to each other than that, cells.
constexpr double connected = 1.8;
/// Outside an edge, that far and around that within this distance, there are open points (cells): else the contact ends
/// at an edge of a body. So it must be for that part of a zone's edges.
constexpr double outside = 0.6, around = 0.75, open_fraction = 0.8;
/// One fit for all closed cells whose zones' middles are nearer to each other than that, cells.
constexpr double same_middle = 0.5;

/// Is the profile Hertz's?
bool is_hertzian(const NarrowZone& zone, double inverse_width, const EdgeOptions& options) {
  return zone.misfit < options.hertzian_misfit + std::pow(inverse_width * zone.cell_size, 3);
}

/// The closed cells with their neighbours: connected zones and what lies around.
class NarrowZones {
 public:
  NarrowZones(const ContactZone& zone, const std::vector<TransmittedForce>& closed, const EdgeOptions& options)
      : options_(options),
        closed_(closed),
        largest_(zone.largest_cell()),
        buckets_(narrow_zone_reach * largest_),
        closed_buckets_(narrow_zone_reach * largest_),
        open_buckets_(options.round_below() * largest_) {
    for (std::size_t i = 0; i < closed.size(); ++i) {
      index_[{closed[i].pair, closed[i].cell, closed[i].image}] = static_cast<int>(i);
      closed_buckets_.add(closed[i].position, static_cast<int>(i));
    }
    for (const auto* list : {&zone.forces(), &zone.images()})
      for (const TransmittedForce& f : *list) {
        const int number = static_cast<int>(points_.size());
        buckets_.add(f.position, number);
        if (!f.closed) open_buckets_.add(f.position, number);
        points_.push_back(&f);
      }
    connect();
  }

  int component(int cell) const { return component_[cell]; }

  /// Closed cells, no images, near open points in zones in which no edge was guessed, or near a sample whose zone is
  /// narrow.
  std::vector<int> candidates(const std::vector<EdgeSample>& samples) const {
    std::vector<char> guessed(closed_.size(), 0);
    std::vector<const EdgeSample*> narrow;
    PointBuckets near(options_.reach_of_sums() * largest_);
    for (const EdgeSample& s : samples) {
      guessed[component_[s.cell]] = 1;
      if (s.inverse_width * 2 * options_.round_below() * s.cell_size < 1) continue;
      near.add(s.origin, static_cast<int>(narrow.size()));
      narrow.push_back(&s);
    }
    std::vector<int> cells;
    for (std::size_t i = 0; i < closed_.size() && !closed_[i].image; ++i) {
      const double h = closed_[i].cell_size;
      bool found =
          !guessed[component_[i]] && has_open_points(closed_[i].pair, closed_[i].position, options_.round_below() * h);
      near.each_near(closed_[i].position, [&](int k) {
        found = found || (narrow[k]->pair == closed_[i].pair &&
                          (narrow[k]->origin - closed_[i].position).norm() < options_.reach_of_sums() * h);
      });
      if (found) cells.push_back(static_cast<int>(i));
    }
    return cells;
  }

  /// Middle of a cell's zone as far as forces count, and the mean normal there.
  std::pair<Vec3, Vec3> middle(int cell) const {
    Vec3 x = closed_[cell].position, normal = closed_[cell].normal;
    for (int step = 0; step < 4; ++step) {
      Vec3 position = Vec3::Zero(), normals = Vec3::Zero();
      double area = 0;
      closed_buckets_.each_near(x, [&](int i) {
        if (component_[i] != component_[cell]) return;
        const double w =
            narrow_zone_weight((closed_[i].position - x).norm() / closed_[cell].cell_size) * closed_[i].area;
        area += w;
        position += w * closed_[i].position;
        normals += w * closed_[i].normal;
      });
      x = position / area;
      normal = normals.normalized();
    }
    return {x, normal};
  }

  /// Within a distance, m; at most EdgeOptions::round_below().
  bool has_open_points(int pair, const Vec3& x, double distance) const {
    bool found = false;
    open_buckets_.each_near(
        x, [&](int i) { found = found || (points_[i]->pair == pair && (points_[i]->position - x).norm() < distance); });
    return found;
  }

  /// From the forces of the cell's zone and all open points around.
  bool fit(int cell, const Vec3& x, const Vec3& normal, double stress_unit, NarrowZone& fitted) const {
    std::vector<const TransmittedForce*> forces;
    buckets_.each_near(x, [&](int i) {
      const TransmittedForce& f = *points_[i];
      if (f.pair != closed_[cell].pair || f.normal.dot(normal) < 0.5) return;
      const auto found = index_.find({f.pair, f.cell, f.image});
      if (found == index_.end() || component_[found->second] == component_[cell]) forces.push_back(&f);
    });
    return fit_narrow_zone(forces, x, normal, closed_[cell].cell_size, stress_unit, fitted, options_);
  }

 private:
  void connect() {
    component_ = connected_sets(
        closed_.size(), connected * largest_, [&](std::size_t i) { return closed_[i].position; },
        [&](int i, int k) {
          const TransmittedForce &a = closed_[i], &b = closed_[k];
          return a.pair == b.pair &&
                 !((a.position - b.position).norm() > connected * std::max(a.cell_size, b.cell_size));
        });
  }

  const EdgeOptions& options_;
  const std::vector<TransmittedForce>& closed_;
  double largest_;  // m, for searches
  std::vector<const TransmittedForce*> points_;
  PointBuckets buckets_;                     // of points_
  PointBuckets closed_buckets_;              // of closed_
  PointBuckets open_buckets_;                // of the open ones of points_
  std::map<std::array<int, 3>, int> index_;  // pair, cell, image -> closed cell
  std::vector<int> component_;               // of closed cells: the first cell of their zone
};

/// A fit with the closed cells that share it.
struct Part {
  Vec3 middle, normal;
  std::shared_ptr<NarrowZone> fitted;  // null: there is none
  std::vector<int> cells;
  std::vector<std::pair<int, EdgePiece>> edges;  // of cells
  bool counts_as_whole = false;
};

std::vector<Part> make_parts(const NarrowZones& zones, const std::vector<TransmittedForce>& closed,
                             const std::vector<int>& cells) {
  std::vector<Part> parts;
  for (const int c : cells) {
    const auto [middle, normal] = zones.middle(c);
    const auto same = std::find_if(parts.begin(), parts.end(), [&, &x = middle](const Part& part) {
      return zones.component(part.cells.front()) == zones.component(c) &&
             (part.middle - x).norm() < same_middle * closed[c].cell_size;
    });
    if (same != parts.end())
      same->cells.push_back(c);
    else
      parts.push_back({middle, normal, nullptr, {c}, {}});
  }
  return parts;
}

}  // namespace

std::vector<EdgeSample> take_narrow_edges(const ContactZone& zone, const std::vector<TransmittedForce>& closed,
                                          double stress_unit, const EdgeOptions& options,
                                          std::vector<EdgeSample>& samples) {
  const NarrowZones zones(zone, closed, options);
  std::vector<Part> parts = make_parts(zones, closed, zones.candidates(samples));
  parallel_for("cgcontact::narrow_edges::parts", parts.size(), 1, [&](std::size_t i) {
    Part& part = parts[i];
    NarrowZone fitted;
    const bool fits = zones.fit(part.cells.front(), part.middle, part.normal, stress_unit, fitted);
    if (fitted.coefficients.isZero()) {
      part.counts_as_whole = true;
      return;
    }
    const double h = fitted.cell_size;
    double inverse_width = 0;
    bool round = false;
    std::size_t open = 0;
    for (const int c : part.cells) {
      EdgePiece piece;
      if (!fitted.edge_near(closed[c].position, closed[c].position, piece)) continue;
      round = round || piece.curvature * options.round_below() * h < -1;
      inverse_width = std::max(inverse_width, piece.inverse_width);
      open += zones.has_open_points(closed[c].pair, piece.origin - outside * h * piece.closed, around * h);
      part.edges.emplace_back(c, piece);
    }
    part.counts_as_whole = round;
    if (!fits || inverse_width * options.narrowest * h > 1) return;
    if (static_cast<double>(open) < open_fraction * static_cast<double>(part.edges.size())) return;
    if (is_hertzian(fitted, inverse_width, options)) part.fitted = std::make_shared<NarrowZone>(fitted);
  });
  std::vector<char> taken(closed.size(), 0);
  std::vector<EdgeSample> edges;
  for (const Part& part : parts) {
    if (!part.counts_as_whole) continue;
    for (const int c : part.cells) taken[c] = 1;
    if (!part.fitted) continue;
    for (const auto& [cell, piece] : part.edges)
      edges.push_back({closed[cell].pair, cell, piece.origin, piece.closed, part.normal, piece.inverse_width,
                       piece.factor, part.fitted, closed[cell].cell_size});
  }
  samples.erase(std::remove_if(samples.begin(), samples.end(), [&](const EdgeSample& s) { return taken[s.cell]; }),
                samples.end());
  return edges;
}

}  // namespace cgcontact
