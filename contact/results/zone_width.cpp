#include "contact/results/zone_width.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "contact/results/contact_zone.hpp"
#include "core/base/parallel.hpp"
#include "recovery/face/connected_sets.hpp"

namespace cgcontact {
namespace {

/// Closed cells are of one zone if their closed parts' centres are nearer to each other than that, cells: a single row
/// of open ones (the discrete pressure oscillates beside a peak) does not part it.
constexpr double connected = 2.3;
/// Zones that carry less of the pair's force are its noise.
constexpr double relevant_part = 0.05;
/// One closed group says no more than that the zone is about a cell: counted zones are no narrower than that, cells.
constexpr double narrowest = 0.5;
/// Half the thickness of the slice through a zone in which the spread of the forces counts, cells.
constexpr double slice = 0.75;
/// The spread may change the width that the states of the points give by that much, cells: groups are whole cells.
constexpr double narrower = 1.5, wider = 1;

/// Points per chunk of the parallel loop.
constexpr std::size_t grain = 1024;
/// One point of so many is glanced at first; equal distances differ by less than the rounding.
constexpr std::size_t stride = 64;
constexpr double rounding = 1e-12;

/// The closed cells of one pair (images too), joined to zones, and the open points around them.
class PairZones {
 public:
  PairZones(const ContactZone& zone, const std::vector<TransmittedForce>& closed_cells, int pair) {
    for (const TransmittedForce& cell : closed_cells)
      if (cell.pair == pair) cells_.push_back(&cell);
    connect();
    for (const auto* list : {&zone.forces(), &zone.images()})
      for (const TransmittedForce& f : *list)
        if (f.pair == pair) add(f);
  }

  /// None: no open point bounds a zone that matters.
  ZoneWidth least_width() const {
    double total = 0;
    ZoneWidth least;
    for (const auto& [name, zone] : zones_) total += zone.force;
    for (const auto& [name, zone] : zones_) {
      if (!(zone.force > relevant_part * total)) continue;
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
  /// A closed point and an open one.
  struct Middle {
    const TransmittedForce *closed = nullptr, *open = nullptr;
    double distance = -1;
  };

  void connect() {
    double largest = 0;
    for (const TransmittedForce* cell : cells_) largest = std::max(largest, cell->cell_size);
    const std::vector<int> zone = connected_sets(
        cells_.size(), connected * largest, [&](std::size_t i) { return cells_[i]->position; },
        [&](int i, int k) {
          const TransmittedForce &a = *cells_[i], &b = *cells_[k];
          return !((a.position - b.position).norm() > connected * std::max(a.cell_size, b.cell_size));
        });
    for (std::size_t i = 0; i < cells_.size(); ++i) zone_of_[{cells_[i]->cell, cells_[i]->image}] = zone[i];
  }

  void add(const TransmittedForce& f) {
    if (!f.closed) {
      open_.push_back(&f);
      return;
    }
    Zone& zone = zones_[zone_of_.at({f.cell, f.image})];
    zone.closed.push_back(&f);
    if (!f.image) zone.force += f.force;
  }

  ZoneWidth width(const Zone& zone) const {
    std::vector<const TransmittedForce*> inner;
    for (const TransmittedForce* f : zone.closed)
      if (!f->image) inner.push_back(f);
    const Middle middle = farthest_from_open(inner);
    if (!middle.open) return {};
    return {refined(zone, middle), middle.closed->cell_size};
  }

  /// Of these points the one that is farthest from the open ones whose normals go its way (of equals the first). Most
  /// points need a glance only: one open point that is nearer than the farthest so far.
  Middle farthest_from_open(const std::vector<const TransmittedForce*>& points) const {
    std::vector<Middle> chunks(num_chunks(points.size(), grain));
    double at_least = -1;  // by a glance at a few of them: the others need not search farther
    for (std::size_t i = 0; i < points.size(); i += stride) {
      const Middle here = nearest_open(*points[i], nullptr, at_least);
      if (here.open) at_least = std::max(at_least, (1 - rounding) * here.distance);
    }
    parallel_chunks("cgcontact::zone_width::farthest_from_open", points.size(), grain,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      Middle& farthest = chunks[chunk];
                      farthest.distance = at_least;
                      const TransmittedForce* latest = nullptr;  // the open point that counted last
                      for (std::size_t i = begin; i < end; ++i) {
                        const Middle here = nearest_open(*points[i], latest, farthest.distance);
                        latest = here.open;
                        if (here.distance > farthest.distance) farthest = here;
                      }
                    });
    Middle farthest;
    for (const Middle& each : chunks)
      if (each.closed && each.distance > farthest.distance) farthest = each;
    return farthest;
  }

  /// The open point nearest to a closed one, or the first found, beginning with `first`, that is not farther than
  /// `enough`.
  Middle nearest_open(const TransmittedForce& point, const TransmittedForce* first, double enough) const {
    Middle nearest{&point, nullptr, std::numeric_limits<double>::infinity()};
    const auto try_point = [&](const TransmittedForce* open) {
      const double distance = (open->position - point.position).norm();
      if (distance < nearest.distance && open->normal.dot(point.normal) >= 0.5) nearest = {&point, open, distance};
      return nearest.distance <= enough;
    };
    if (first && try_point(first)) return nearest;
    nearest = {&point, nullptr, std::numeric_limits<double>::infinity()};
    for (const TransmittedForce* open : open_)
      if (try_point(open)) break;
    return nearest;
  }

  /// Under Hertz's line and round contacts the forces in a slice through the middle spread by a quarter of the width.
  double refined(const Zone& zone, const Middle& middle) const {
    const double h = middle.closed->cell_size, counted = 2 * middle.distance / h;
    const Vec3 &place = middle.closed->position, &normal = middle.closed->normal;
    Vec3 across = middle.open->position - place;
    across -= across.dot(normal) * normal;
    if (!(across.norm() > 0)) return counted;
    across.normalize();
    const Vec3 along = normal.cross(across);
    double force = 0, first = 0, second = 0;
    for (const TransmittedForce* f : zone.closed) {
      const Vec3 d = (f->position - place) / h;
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

  std::vector<const TransmittedForce*> cells_, open_;
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
      const ZoneWidth least = PairZones(zone, closed, p).least_width();
      if (least.cells) widths[p] = {std::max(*least.cells, narrowest), least.cell};
    }
  }
  std::size_t group = 0;
  for (std::size_t p = 0; p < state.pairs.size() && p < state.outer.small_zone_width.size(); ++p) {
    double total = 0;
    for (std::size_t g = 0; g < state.pairs[p].groups.size(); ++g)
      total += std::abs(state.outer.group_force[group++]) * state.scales.stress * std::pow(state.scales.length, 2);
    const auto [width, cell, force] = state.outer.small_zone_width[p];
    if (width > 0 && force > relevant_part * total && width / cell < widths[p].cells.value_or(1e300))
      widths[p] = {width / cell, cell};
  }
  return widths;
}

}  // namespace cgcontact
