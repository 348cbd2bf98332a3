#include "contact/solve/forces/small_zones.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/groups/indentation.hpp"
#include "core/base/process/parallel.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

/// Mean displacement of a square of side h under a uniform pressure, times E* h / F.
constexpr double own_displacement = 0.946;
/// Largest fraction of a force's change that the cells' own deformation may take.
constexpr double max_own_fraction = 0.8;
/// Cells within which forces act on the local depth as a zone does, not as cells see it: the next groups.
constexpr double zone_reach = 1.5;
/// Samples serve until the overlap has grown or shrunk by that.
constexpr double grown = 1.5, shrunk = 0.5;

/// Groups of a pair by the cells of its primary body that they have points in: several, under a larger cell of the
/// other body.
class GroupsByCell {
 public:
  /// first: number of the pair's first group.
  GroupsByCell(const CutCells& cells, const ContactPair& pair, std::size_t first)
      : cells_(cells), pair_(pair), first_(first) {}
  void add(std::size_t group) {
    for (const int cell : cells_of(group)) groups_[cell_index(cells_, cell)].push_back(group);
  }
  /// A group may be visited more than once.
  template <typename Visit>
  void each_around(std::size_t group, int reach, const Visit& visit) const {
    for (const int cell : cells_of(group))
      each_cell_index_around(cells_.num_levels(), cell_index(cells_, cell), reach, [&](const CellIndex& at) {
        const auto found = groups_.find(at);
        if (found == groups_.end()) return;
        for (const std::size_t g : found->second) visit(g);
      });
  }

 private:
  std::vector<int> cells_of(std::size_t group) const {
    const ContactGroup& own = pair_.groups[group - first_];
    std::vector<int> cells;
    for (int q = own.first_point; q < own.last_point; ++q)  // mostly of one cell
      if (cells.empty() || cells.back() != pair_.points.primary_cell(q)) cells.push_back(pair_.points.primary_cell(q));
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  const CutCells& cells_;
  const ContactPair& pair_;
  const std::size_t first_;
  std::map<CellIndex, std::vector<std::size_t>> groups_;
};

}  // namespace

/// Overlap of the undeformed bodies.
struct SmallZones::Overlap {
  double volume = 0, area = 0;
  Vec3 first = Vec3::Zero();  ///< moments of the area
  Mat3 second = Mat3::Zero();

  Overlap() = default;
  Overlap(const std::vector<GapSample>& samples, double approach) {
    for (const GapSample& s : samples) {
      const double depth = approach - s.distance;
      if (depth <= 0) continue;
      volume += depth * s.area;
      area += s.area;
      first += s.area * s.x;
      second += s.area * (s.x * s.x.transpose() + s.area / 12 * Mat3::Identity());
    }
  }
  /// One of its images.
  void add(const Overlap& other, const std::vector<SymmetryPlane>& planes, unsigned image) {
    volume += other.volume;
    area += other.area;
    const Vec3 mean = other.first / other.area;
    const Mat3 spread = other.second / other.area - mean * mean.transpose();
    const Vec3 x = with_images(mean, planes)[image];
    first += other.area * x;
    second += other.area * (spread + x * x.transpose());  // the spread is not turned: zones are small
  }
  /// Long and short axes of the ellipse with the same moments, m.
  std::pair<double, double> axes() const { return axes_of_overlap(area, first, second); }
};

/// Law of one zone, by its groups.
struct SmallZones::Law {
  std::vector<double> force, stiffness, bedding, width;  ///< N, N/m, Pa/m, m
  std::vector<double> extra;                             ///< m: approach that the cells' deformation stands for
  std::vector<double> own_fraction;                      ///< change of the force with the force that extra is made of
  double total = 0, fraction_of_cells = 0;               ///< N; of the approach
};

SmallZones::SmallZones(const std::vector<BodyModel>& bodies, std::vector<ContactPair>& pairs,
                       std::vector<DisplacementDriven> led, const SolverOptions& options)
    : bodies_(bodies), pairs_(pairs), led_(std::move(led)), options_(options) {
  std::size_t size = 0;
  for (const ContactPair& pair : pairs) {
    first_.push_back(size);
    size += pair.groups.size();
    planes_.emplace_back();
    if (led_[planes_.size() - 1] == DisplacementDriven::no) continue;
    const BodyModel &a = bodies[pair.primary], &b = bodies[pair.secondary];
    planes_.back() = common_planes(symmetry_planes(a.cut_cells, a.boundary), symmetry_planes(b.cut_cells, b.boundary),
                                   a.cut_cells.grid.cell_size);
  }
  groups_.resize(size);
}

void SmallZones::forget() {
  std::fill(groups_.begin(), groups_.end(), State());
  relative_change_ = squeeze_ = 0;
}

int SmallZones::count(int pair) const {
  int sum = 0;
  for (std::size_t g = first_[pair]; g < first_[pair] + pairs_[pair].groups.size(); ++g)
    sum += groups_[g].small && groups_[g].force > 0;
  return sum;
}

SmallZones::Width SmallZones::width(int pair) const {
  double sum = 0, force = 0, largest = 0;
  Width mean;
  for (std::size_t g = first_[pair]; g < first_[pair] + pairs_[pair].groups.size(); ++g) {
    const State& state = groups_[g];
    if (!state.small) continue;
    sum += state.force * state.width;
    force += state.force;
    if (state.force > largest) largest = state.force, mean.cell = group(pair, g).larger_cell;
  }
  if (force > 0) mean.width = sum / force;
  mean.force = force;
  return mean;
}

ZoneSpring SmallZones::spring(std::size_t g) const {
  ZoneSpring spring;
  const std::size_t pair = std::upper_bound(first_.begin(), first_.end(), g) - first_.begin() - 1;
  const State& state = groups_[g];
  if (led_[pair] != DisplacementDriven::squeezed || !(state.small || state.beside)) return spring;
  if (state.small && state.force > 0) {
    spring.stiffness = state.stiffness;
    spring.points.push_back({1, state.force + state.stiffness * state.gap});
    return spring;
  }
  double area = 0;
  for (const GapSample& sample : state.samples) area += sample.area;
  spring.stiffness = indentation * effective_modulus(pair) / std::sqrt(area);
  const double closed = group(pair, g).initial_gap + pairs_[pair].interference;
  for (const GapSample& sample : state.samples)
    spring.points.push_back({sample.area, spring.stiffness * (closed - sample.distance)});
  return spring;
}

double SmallZones::effective_modulus(std::size_t pair) const {
  return cgcontact::effective_modulus(bodies_[pairs_[pair].primary].spec->material,
                                      bodies_[pairs_[pair].secondary].spec->material);
}

/// Groups of zones that are several cells wide, and those within two cells of them: closed ones that join one whose
/// neighbours are all closed.
std::vector<char> SmallZones::near_resolved(std::size_t pair) const {
  const ContactPair& p = pairs_[pair];
  GroupsByCell by_cell(bodies_[p.primary].cut_cells, p, 0);
  std::vector<char> closed(p.groups.size(), 0), resolved(p.groups.size(), 0), near(p.groups.size(), 0);
  for (std::size_t g = 0; g < p.groups.size(); ++g) {
    by_cell.add(g);
    if (has(first_[pair] + g)) continue;
    closed[g] = is_closed(p, p.groups[g]);
  }
  std::vector<std::size_t> next;
  for (std::size_t g = 0; g < p.groups.size(); ++g) {
    if (!closed[g]) continue;
    bool inside = true;
    by_cell.each_around(g, 1, [&](std::size_t other) { inside &= closed[other] != 0; });
    if (inside) next.push_back(g);
  }
  for (const std::size_t g : next) resolved[g] = 1;
  while (!next.empty()) {
    const std::size_t g = next.back();
    next.pop_back();
    by_cell.each_around(g, 2, [&](std::size_t other) { near[other] = 1; });
    by_cell.each_around(g, 1, [&](std::size_t other) {
      if (!closed[other] || resolved[other]) return;
      resolved[other] = 1;
      next.push_back(other);
    });
  }
  return near;
}

/// New samples where those that there are were made for another depth; overlap: m, at zero gap in the group's mean.
void SmallZones::sample(std::size_t pair, std::size_t g, double overlap) {
  State& state = groups_[g];
  if (state.limit != 0 && std::abs(overlap - state.limit) < 1e-3 * std::abs(state.limit)) return;
  if (state.samples.empty() && state.limit != 0 && overlap < state.limit) return;  // nothing up to a larger depth
  if (!state.samples.empty()) {
    double smallest = 1e300;
    for (const GapSample& sample : state.samples) smallest = std::min(smallest, sample.distance);
    const double before = state.limit - smallest, now = overlap - smallest;
    if (now > shrunk * before && now < grown * before) return;
  }
  state.limit = overlap;
  state.samples = sample_gap(bodies_, pairs_[pair], group(pair, g), overlap);
}

/// Groups with samples, joined over neighbouring cells.
std::vector<SmallZones::Zone> SmallZones::zones(std::size_t pair, const std::vector<std::size_t>& groups) const {
  GroupsByCell by_cell(bodies_[pairs_[pair].primary].cut_cells, pairs_[pair], first_[pair]);
  std::map<std::size_t, bool> seen;
  for (const std::size_t g : groups) {
    by_cell.add(g);
    seen[g] = false;
  }
  std::vector<Zone> zones;
  for (const std::size_t start : groups) {
    if (seen[start]) continue;
    zones.emplace_back();
    std::vector<std::size_t> next{start};
    seen[start] = true;
    while (!next.empty()) {
      const std::size_t g = next.back();
      next.pop_back();
      zones.back().groups.push_back(g);
      by_cell.each_around(g, 1, [&](std::size_t other) {
        if (seen[other]) return;
        seen[other] = true;
        next.push_back(other);
      });
    }
    std::sort(zones.back().groups.begin(), zones.back().groups.end());
  }
  return zones;
}

/// Groups of a zone that act on each other, with images in planes of symmetry: their positions, and for each group
/// those within reach.
struct SmallZones::Neighbours {
  struct Image {
    std::size_t group;  ///< of the zone
    unsigned planes;    ///< index among with_images()
    double distance;    ///< m
  };
  std::vector<std::vector<Image>> of_group;
};

SmallZones::Neighbours SmallZones::neighbours(std::size_t pair, const Zone& zone) const {
  std::vector<Vec3> centres;
  for (const std::size_t k : zone.groups) {
    const ContactGroup& g = group(pair, k);
    Vec3 sum = Vec3::Zero();
    for (int q = g.first_point; q < g.last_point; ++q)
      sum += pairs_[pair].points.weight(q) / g.area * pairs_[pair].points.x(q);
    centres.push_back(sum);
  }
  Neighbours found;
  found.of_group.resize(centres.size());
  for (std::size_t j = 0; j < centres.size(); ++j) {
    const std::vector<Vec3> images = with_images(centres[j], planes_[pair]);
    for (unsigned k = 0; k < images.size(); ++k)
      for (std::size_t i = 0; i < centres.size(); ++i) {
        const double distance = (centres[i] - images[k]).norm();
        const double h = std::max(group(pair, zone.groups[i]).larger_cell, group(pair, zone.groups[j]).larger_cell);
        if (distance <= zone_reach * h) found.of_group[i].push_back({j, k, distance});
      }
  }
  return found;
}

/// The forces that the present gaps give; `forces`: those that the cells deform under.
SmallZones::Law SmallZones::evaluate(std::size_t pair, const Zone& zone, const std::vector<double>& gap_change,
                                     const std::vector<double>& forces, bool decide) const {
  const std::size_t n = zone.groups.size();
  const double modulus = effective_modulus(pair);
  const Neighbours near = neighbours(pair, zone);
  const auto compliance = [&](const Neighbours::Image& image) {
    const double h = group(pair, zone.groups[image.group]).larger_cell;
    return std::min(own_displacement / h, 1 / (pi * std::max(image.distance, 1e-6 * h))) / modulus;
  };
  const auto approach_of_cells = [&](std::size_t i, const auto& force_of) {
    double sum = 0;
    for (const Neighbours::Image& image : near.of_group[i])
      sum += std::max(force_of(image.group), 0.0) * compliance(image);
    return sum;
  };
  Law law;
  std::vector<Overlap> overlaps(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t g = zone.groups[i];
    law.extra.push_back(approach_of_cells(i, [&](std::size_t k) { return forces[zone.groups[k]]; }));
    overlaps[i] = Overlap(groups_[g].samples, pairs_[pair].interference - gap_change[g] + law.extra[i]);
  }
  double depth = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const State& state = groups_[zone.groups[i]];
    double bedding = 0, width = state.width;
    if (!decide && state.small) {
      bedding = state.bedding;
    } else if (overlaps[i].area > 0) {
      Overlap whole;
      for (const Neighbours::Image& image : near.of_group[i])
        if (overlaps[image.group].area > 0) whole.add(overlaps[image.group], planes_[pair], image.planes);
      const auto [length, breadth] = whole.axes();
      bedding = indentation * modulus * slenderness_factor(length / breadth) / std::sqrt(whole.area);
      width = breadth * width_of_overlap;
    }
    law.width.push_back(width);
    law.bedding.push_back(bedding);
    law.force.push_back(bedding * overlaps[i].volume);
    law.stiffness.push_back(bedding * overlaps[i].area);
    double own = 0;
    for (const Neighbours::Image& image : near.of_group[i])
      if (image.group == i) own += compliance(image);
    law.own_fraction.push_back(std::min(law.stiffness.back() * own, max_own_fraction));
    law.total += law.force.back();
    if (overlaps[i].area > 0) depth += law.force.back() * overlaps[i].volume / overlaps[i].area;
  }
  double of_cells = 0;
  for (std::size_t i = 0; i < n; ++i)
    of_cells += law.force[i] * approach_of_cells(i, [&](std::size_t k) { return law.force[k]; });
  // The mean depth is half of the approach on a sphere.
  law.fraction_of_cells = depth > 0 ? of_cells / (2 * depth) : 0.0;
  return law;
}

/// Returns the approach of the far bodies at one group, less its own deformation of the cells, m.
double SmallZones::approach(std::size_t pair, std::size_t g, const std::vector<double>& gap_change,
                            const std::vector<double>& group_force) const {
  return pairs_[pair].interference - gap_change[g] +
         own_displacement / (effective_modulus(pair) * group(pair, g).larger_cell) * std::max(group_force[g], 0.0);
}

/// Returns the deepest overlap of the faces of squeezed bodies, m, at most a cell: by that much deeper a body may come
/// on its other side.
double SmallZones::deepest_squeeze(const std::vector<double>& gap_change,
                                   const std::vector<double>& group_force) const {
  double deepest = 0;
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    if (led_[pair] != DisplacementDriven::squeezed) continue;
    for (std::size_t g = first_[pair]; g < first_[pair] + pairs_[pair].groups.size(); ++g)
      deepest =
          std::max(deepest, std::min(group(pair, g).larger_cell, approach(pair, g, gap_change, group_force) -
                                                                     nearest_distance(pairs_[pair], group(pair, g))));
  }
  return deepest;
}

/// Decides which groups of a pair lie in small zones.
void SmallZones::decide_pair(std::size_t pair, const std::vector<double>& gap_change,
                             const std::vector<double>& group_force) {
  const ContactPair& p = pairs_[pair];
  const double deeper = led_[pair] == DisplacementDriven::squeezed ? squeeze_ : 0;
  const std::vector<char> resolved = near_resolved(pair);
  std::vector<std::size_t> candidates;
  for (std::size_t k = 0; k < p.groups.size(); ++k) {
    if (resolved[k]) continue;
    const std::size_t g = first_[pair] + k;
    if (nearest_distance(pairs_[pair], group(pair, g)) - approach(pair, g, gap_change, group_force) <
        p.groups[k].larger_cell)
      candidates.push_back(g);
  }
  parallel_for("cgcontact::small_zones::sample_candidates", candidates.size(), 1, [&](std::size_t i) {
    const std::size_t g = candidates[i];
    sample(pair, g, approach(pair, g, gap_change, group_force) + deeper);
  });
  std::vector<char> small(p.groups.size(), 0), beside(p.groups.size(), 0);
  candidates.erase(
      std::remove_if(candidates.begin(), candidates.end(), [&](std::size_t g) { return groups_[g].samples.empty(); }),
      candidates.end());
  for (const Zone& zone : zones(pair, candidates)) {
    const Law law = evaluate(pair, zone, gap_change, group_force, true);
    const auto any = [&](const auto& is) { return std::any_of(zone.groups.begin(), zone.groups.end(), is); };
    const bool was = any([&](std::size_t g) { return has(g); });
    const bool seen = !was && any([&](std::size_t g) { return group_force[g] > 0; });  // by mean gaps
    if (law.total > 0 && law.fraction_of_cells < (seen ? options_.small_zone_joins : options_.small_zone_leaves))
      for (const std::size_t g : zone.groups) small[g - first_[pair]] = 1;
    if (law.total == 0 && !seen)
      for (const std::size_t g : zone.groups) beside[g - first_[pair]] = 1;
  }
  for (std::size_t k = 0; k < p.groups.size(); ++k) {
    State& state = groups_[first_[pair] + k];
    state.small = small[k] != 0;
    state.beside = beside[k] != 0;
    if (!state.small) state.force = state.stiffness = 0;
  }
}

/// Active are the points in the overlap, or the nearest one.
void SmallZones::set_active_points(std::size_t pair, std::size_t g, double change, double extra) {
  ContactPair& p = pairs_[pair];
  const ContactGroup& own = group(pair, g);
  const double approach = p.interference - change + extra;
  int nearest = own.first_point;
  bool any = false;
  for (int q = own.first_point; q < own.last_point; ++q) {
    p.points.set_active(q, groups_[g].force > 0 && p.points.distance(q) < approach);
    any |= p.points.active(q);
    if (p.points.distance(q) < p.points.distance(nearest)) nearest = q;
  }
  if (!any && groups_[g].force > 0) p.points.set_active(nearest, true);
}

void SmallZones::update(const std::vector<double>& gap_change, const std::vector<double>& group_force, bool decide) {
  double change = 0, sum = 0;
  if (decide) squeeze_ = std::max(squeeze_, deepest_squeeze(gap_change, group_force));
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    if (led_[pair] == DisplacementDriven::no) continue;
    if (decide) decide_pair(pair, gap_change, group_force);
    std::vector<std::size_t> groups;
    for (std::size_t k = 0; k < pairs_[pair].groups.size(); ++k)
      if (has(first_[pair] + k)) groups.push_back(first_[pair] + k);
    if (groups.empty()) continue;
    const double deeper = led_[pair] == DisplacementDriven::squeezed ? squeeze_ : 0;
    if (decide)
      parallel_for("cgcontact::small_zones::sample_groups", groups.size(), 1, [&](std::size_t i) {
        sample(pair, groups[i], approach(pair, groups[i], gap_change, group_force) + deeper);
      });
    for (const Zone& zone : zones(pair, groups)) {
      const Law law = evaluate(pair, zone, gap_change, group_force, decide);
      for (std::size_t i = 0; i < zone.groups.size(); ++i) {
        const std::size_t g = zone.groups[i];
        State& state = groups_[g];
        const double gap = group(pair, g).initial_gap + gap_change[g];
        change += std::abs(law.force[i] - group_force[g]);
        sum += law.force[i];
        // Newton's step for the force that is also the one which deforms the cells.
        const double rest = 1 - law.own_fraction[i];
        state.force = std::max((law.force[i] - law.own_fraction[i] * std::max(group_force[g], 0.0)) / rest, 0.0);
        state.stiffness = law.stiffness[i] / rest;
        state.bedding = law.bedding[i];
        state.width = law.width[i];
        state.gap = gap;
        set_active_points(pair, g, gap_change[g], law.extra[i]);
      }
    }
  }
  relative_change_ = sum > 0 ? change / sum : 0.0;
}

}  // namespace cgcontact
