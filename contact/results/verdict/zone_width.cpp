#include "contact/results/verdict/zone_width.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unsupported/Eigen/BVH>
#include <utility>

#include "contact/results/verdict/contact_zone.hpp"
#include "core/base/process/parallel.hpp"
#include "recovery/face/connected_sets.hpp"

namespace cgcontact {
namespace {

/// Distance, cells, below which the closed areas' centres of two cells are of one zone: a single row of open ones (the
/// discrete pressure oscillates beside a peak) does not separate it.
constexpr double max_cell_spacing = 2.3;
/// Zones that carry less of the pair's force are its noise.
constexpr double min_zone_fraction = 0.05;
/// One closed group says no more than that the zone is about a cell: counted zones are no narrower than that, cells.
constexpr double narrowest = 0.5;
/// Half the thickness of the slice through a zone in which the spread of the forces counts, cells.
constexpr double slice = 0.75;
/// The spread may change the width that the states of the points give by that much, cells: groups are whole cells.
constexpr double narrower = 1.5, wider = 1;

/// Radius, in distances from the open points, of the closed points that a ridge point stands for: in a strip these
/// reach from edge to edge halfway to the next ridge point.
constexpr double neighbourhood = 2;

/// Open point, for Eigen's hierarchy of bounding boxes.
struct OpenPoint {
  const TransmittedForce* force;
};
Eigen::AlignedBox3d bounding_box(const OpenPoint& point) { return Eigen::AlignedBox3d(point.force->position); }

/// Closed point and the nearest open one whose normal goes its way, which may be missing; for Eigen::BVMinimize.
struct Middle {
  using Scalar = double;
  const TransmittedForce *closed, *open = nullptr;
  double distance = std::numeric_limits<double>::infinity();

  double minimumOnVolume(const Eigen::AlignedBox3d& box) const { return box.exteriorDistance(closed->position); }
  double minimumOnObject(const OpenPoint& point) {
    const double here = (point.force->position - closed->position).norm();
    if (here < distance && point.force->normal.dot(closed->normal) >= 0.5) {
      open = point.force;
      distance = here;
    }
    return distance;
  }
};

/// The closed cells of one pair (images too), joined to zones, and the open points around them.
class PairZones {
 public:
  PairZones(const ContactZone& zone, const std::vector<TransmittedForce>& closed_cells, int pair) {
    for (const TransmittedForce& cell : closed_cells)
      if (cell.pair == pair) cells_.push_back(&cell);
    connect();
    std::vector<OpenPoint> open;
    for (const auto* list : {&zone.forces(), &zone.images()})
      for (const TransmittedForce& f : *list) {
        if (f.pair != pair) continue;
        if (f.closed)
          add(f);
        else
          open.push_back({&f});
      }
    bounded_ = !open.empty();
    open_.init(open.begin(), open.end());
  }

  /// None: no open point bounds a zone that matters.
  ZoneWidth min_width() const {
    double total = 0;
    ZoneWidth least;
    for (const auto& [name, zone] : zones_) total += zone.force;
    for (const auto& [name, zone] : zones_) {
      if (!(zone.force > min_zone_fraction * total)) continue;
      const ZoneWidth here = width(zone);
      if (here.cells && (!least.cells || *here.cells < *least.cells)) least = here;
    }
    return least;
  }

 private:
  struct Zone {
    double force = 0;                             // N, without images
    std::vector<const TransmittedForce*> closed;  // with images
  };

  void connect() {
    double largest = 0;
    for (const TransmittedForce* cell : cells_) largest = std::max(largest, cell->cell_size);
    const std::vector<int> zone = connected_sets(
        cells_.size(), max_cell_spacing * largest, [&](std::size_t i) { return cells_[i]->position; },
        [&](int i, int k) {
          const TransmittedForce &a = *cells_[i], &b = *cells_[k];
          return !((a.position - b.position).norm() > max_cell_spacing * std::max(a.cell_size, b.cell_size));
        });
    for (std::size_t i = 0; i < cells_.size(); ++i) zone_of_[{cells_[i]->cell, cells_[i]->image}] = zone[i];
  }

  void add(const TransmittedForce& f) {
    Zone& zone = zones_[zone_of_.at({f.cell, f.image})];
    zone.closed.push_back(&f);
    if (!f.image) zone.force += f.force;
  }

  /// Averages the width over the zone's ridge, weighted by the forces on both sides of it.
  ZoneWidth width(const Zone& zone) const {
    if (!bounded_) return {};
    double force = 0, cells = 0, width = 0;
    for (const auto& [middle, of_middle] : ridge(zone)) {
      const double here = refined(zone, middle);
      force += of_middle;
      cells += of_middle * here;
      width += of_middle * here * middle.closed->cell_size;
    }
    if (!(force > 0)) return {};
    return {cells / force, width / cells};
  }

  /// Finds the closed point, images left out, that is farthest from the open ones, then the farthest beyond its
  /// neighbourhood, and so on; with the neighbourhood's force, N.
  std::vector<std::pair<Middle, double> > ridge(const Zone& zone) const {
    std::vector<Middle> points;
    for (const TransmittedForce* f : zone.closed)
      if (!f->image) points.push_back({f});
    parallel_for("cgcontact::zone_width::nearest_open", points.size(), grain_of_medium,
                 [&](std::size_t i) { Eigen::BVMinimize(open_, points[i]); });
    points.erase(std::remove_if(points.begin(), points.end(), [](const Middle& m) { return !m.open; }), points.end());
    std::stable_sort(points.begin(), points.end(),
                     [](const Middle& a, const Middle& b) { return a.distance > b.distance; });
    std::vector<std::pair<Middle, double> > ridge;
    while (!points.empty()) {
      const Middle middle = points.front();
      const double reach = std::max(neighbourhood * middle.distance, middle.closed->cell_size);
      double force = 0;
      const auto beyond = [&](const Middle& m) {
        if ((m.closed->position - middle.closed->position).norm() > reach) return true;
        force += m.closed->force;
        return false;
      };
      points.erase(std::stable_partition(points.begin(), points.end(), beyond), points.end());
      ridge.emplace_back(middle, force);
    }
    return ridge;
  }

  /// Under Hertz's line and round contacts the forces in a slice through the middle spread by a quarter of the width.
  double refined(const Zone& zone, const Middle& middle) const {
    const double h = middle.closed->cell_size, counted = 2 * middle.distance / h;
    const Vec3 &position = middle.closed->position, &normal = middle.closed->normal;
    Vec3 across = middle.open->position - position;
    across -= across.dot(normal) * normal;
    if (!(across.norm() > 0)) return counted;
    across.normalize();
    const Vec3 along = normal.cross(across);
    double force = 0, first = 0, second = 0;
    for (const TransmittedForce* f : zone.closed) {
      const Vec3 d = (f->position - position) / h;
      if (std::abs(along.dot(d)) > slice || std::abs(across.dot(d)) > counted + 1) continue;
      const double x = across.dot(d);
      force += f->spread_force;
      first += f->spread_force * x;
      second += f->spread_force * x * x;
    }
    if (!(force > 0)) return counted;
    const double variance = second / force - std::pow(first / force, 2) - 1.0 / 12;  // less that within a cell
    const double spread = 4 * std::sqrt(std::max(variance, 0.0));
    return std::clamp(spread, std::max(counted - narrower, 0.5 * counted), counted + wider);
  }

  std::vector<const TransmittedForce*> cells_;
  bool bounded_ = false;  // by open points
  Eigen::KdBVH<double, 3, OpenPoint> open_;
  std::map<std::array<int, 2>, int> zone_of_;  // cell, image
  std::map<int, Zone> zones_;
};

}  // namespace

std::vector<ZoneWidth> zone_widths(const SolvedState& state) {
  std::vector<RecoveryBody> bodies;
  for (std::size_t b = 0; b < state.bodies.size(); ++b)
    bodies.push_back({&state.system.meshes[b], nullptr, &state.bodies[b].boundary, {Subset(0), CoefficientView()}});
  std::vector<ZoneWidth> widths(state.pairs.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (state.bodies[b].boundary.links.empty()) continue;
    const ContactZone zone(bodies, b);
    std::set<int> pairs;
    for (const TransmittedForce& f : zone.forces()) pairs.insert(f.pair);
    const std::vector<TransmittedForce> closed = zone.closed_cells();
    for (const int p : pairs) {
      const ZoneWidth least = PairZones(zone, closed, p).min_width();
      if (least.cells) widths[p] = {std::max(*least.cells, narrowest), least.cell};
    }
  }
  std::size_t group = 0;
  for (std::size_t p = 0; p < state.pairs.size() && p < state.outer.small_zone_width.size(); ++p) {
    double total = 0;
    for (std::size_t g = 0; g < state.pairs[p].groups.size(); ++g)
      total += std::abs(state.outer.group_force[group++]) * state.scales.stress * std::pow(state.scales.length, 2);
    const auto [width, cell, force] = state.outer.small_zone_width[p];
    if (width > 0 && force > min_zone_fraction * total && width / cell < widths[p].cells.value_or(1e300))
      widths[p] = {width / cell, cell};
  }
  return widths;
}

}  // namespace cgcontact
