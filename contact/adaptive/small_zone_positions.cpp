#include "contact/adaptive/small_zone_positions.hpp"

#include <algorithm>
#include <cmath>

#include "contact/groups/gap_samples.hpp"
#include "contact/groups/indentation.hpp"
#include "core/base/process/parallel.hpp"
#include "recovery/face/connected_sets.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {
namespace {

/// Cells: closed groups of one zone have centres no farther apart; groups within the second distance may hold its wider
/// overlap.
constexpr double max_group_spacing = 2, around = 3;
/// Cells: a plane of symmetry so near to a zone's centre cuts it.
constexpr double near_plane = 1.5;
/// Fraction of the groups' area: an overlap that fills more is not smaller than the cells.
constexpr double fills = 0.8;
constexpr int max_doublings = 30, bisections = 40;
/// Power of the depth that the force of a round zone goes with; that of other zones goes with a smaller one.
constexpr double force_power = 1.5;

struct Group {
  const ContactGroup* group;
  Vec3 centre;
  double force;  // N, compression positive
  bool closed;
};

std::vector<Group> groups_of(const SolvedState& state, std::size_t p) {
  std::size_t row = 0;
  for (std::size_t k = 0; k < p; ++k) row += state.pairs[k].groups.size();
  const ContactPair& pair = state.pairs[p];
  const double unit = state.scales.stress * state.scales.length * state.scales.length;
  std::vector<Group> groups;
  for (const ContactGroup& group : pair.groups)
    groups.push_back({&group, centre_of(pair, group), unit * state.outer.group_force[row++], is_closed(pair, group)});
  return groups;
}

/// One zone: its closed groups and those beside them.
class Overlap {
 public:
  Overlap(const SolvedState& state, std::size_t p, std::vector<Group> groups)
      : state_(state), pair_(state.pairs[p]), groups_(std::move(groups)) {
    for (const Group& g : groups_) {
      area_ += g.group->area;
      force_ += std::max(g.force, 0.0);
      cell_ = std::max(cell_, g.group->larger_cell);
      nearest_ = std::min(nearest_, nearest_distance(pair_, *g.group));
    }
    const BodyModel &a = state.bodies[pair_.primary], &b = state.bodies[pair_.secondary];
    common_planes_ = common_planes(symmetry_planes(a.cut_cells, a.boundary), symmetry_planes(b.cut_cells, b.boundary),
                                   a.cut_cells.grid.cell_size);
    for (const Group& g : groups_) samplers_.emplace_back(state.bodies, pair_, *g.group);
    Vec3 mean = Vec3::Zero();
    for (const Group& g : groups_) mean += g.centre / static_cast<double>(groups_.size());
    slice_ = a.cut_cells.grid.slice * a.cut_cells.grid.ring(a.cut_cells.grid.to_grid(mean));
    modulus_ =
        effective_modulus(state.scene.bodies[pair_.primary].material, state.scene.bodies[pair_.secondary].material);
  }

  /// Samples of the overlap under the zone's force; empty: it fills the groups, or there is no force.
  std::vector<GapSample> samples() {
    if (!(force_ > 0)) return {};
    double depth = 0.01 * force_ / (modulus_ * cell_), limit = 0, force = 0;
    std::vector<GapSample> found;
    for (int k = 0;; ++k, depth *= force > 0 ? std::max(2.0, std::pow(force_ / force, 1 / force_power)) : 2) {
      limit = nearest_ + depth;
      found = sampled(limit);
      double area = 0;
      for (const GapSample& s : found)
        if (s.distance < limit) area += s.area;
      if (area > fills * area_ || k == max_doublings) return {};
      force = force_at(found, limit);
      if (force >= force_) break;
    }
    double low = limit, high = limit;
    for (const GapSample& s : found) low = std::min(low, s.distance);  // nearer than any contact point
    for (int k = 0; k < bisections; ++k) {
      const double middle = 0.5 * (low + high);
      (force_at(found, middle) < force_ ? low : high) = middle;
    }
    found.erase(std::remove_if(found.begin(), found.end(), [&](const GapSample& s) { return s.distance >= high; }),
                found.end());
    return found;
  }

  /// m: of the contact zone in the overlap.
  double width(const std::vector<GapSample>& samples) const {
    if (slice_ > 0) return line(samples, 1e300).second;
    return width_of_overlap * axes(samples, 1e300).second;
  }
  /// m, around a sample: what it stands for.
  double reach(const GapSample& sample) const {
    return std::sqrt(slice_ > 0 ? sample.area * cell_ / slice_ : sample.area);
  }

 private:
  std::vector<GapSample> sampled(double limit) {
    std::vector<std::vector<GapSample>> of_group(groups_.size());
    parallel_for("cgcontact::small_zone_places::sample", of_group.size(), 1,
                 [&](std::size_t g) { of_group[g] = samplers_[g].samples(limit); });
    std::vector<GapSample> all;
    for (const auto& found : of_group) all.insert(all.end(), found.begin(), found.end());
    choose_planes(all);
    return all;
  }

  /// Those that cut the overlap.
  void choose_planes(const std::vector<GapSample>& samples) {
    planes_.clear();
    if (samples.empty()) return;
    Vec3 mean = Vec3::Zero();
    for (const GapSample& s : samples) mean += s.x / static_cast<double>(samples.size());
    for (const SymmetryPlane& plane : common_planes_)
      if ((with_images(mean, {plane}).back() - mean).norm() < 2 * near_plane * cell_) planes_.push_back(plane);
  }

  /// Under line contact: volume, and width of the overlap, planes of symmetry being respected.
  std::pair<double, double> line(const std::vector<GapSample>& samples, double limit) const {
    double volume = 0, area = 0;
    for (const GapSample& s : samples) {
      if (s.distance >= limit) continue;
      volume += (limit - s.distance) * s.area;
      area += s.area;
    }
    return {volume, std::ldexp(area / slice_, static_cast<int>(planes_.size()))};
  }

  double force_at(const std::vector<GapSample>& samples, double limit) const {
    if (slice_ > 0) {
      const auto [volume, width] = line(samples, limit);
      return width > 0 ? line_indentation * modulus_ * volume / width : 0;
    }
    double volume = 0, area = 0;
    for (const GapSample& s : samples) {
      if (s.distance >= limit) continue;
      volume += (limit - s.distance) * s.area;
      area += s.area;
    }
    const double images = std::ldexp(1.0, static_cast<int>(planes_.size()));
    if (!(area > 0)) return 0;
    const auto [length, breadth] = axes(samples, limit);
    return indentation * modulus_ * slenderness_factor(length / breadth) * volume / std::sqrt(area * images);
  }

  /// Long and short axis of the ellipse with the same moments as the overlap, planes of symmetry being respected, m.
  std::pair<double, double> axes(const std::vector<GapSample>& samples, double limit) const {
    double area = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (const GapSample& s : samples) {
      if (s.distance >= limit) continue;
      for (const Vec3& x : with_images(s.x, planes_)) {
        area += s.area;
        first += s.area * x;
        second += s.area * (x * x.transpose() + s.area / 12 * Mat3::Identity());
      }
    }
    return axes_of_overlap(area, first, second);
  }

  const SolvedState& state_;
  const ContactPair& pair_;
  std::vector<Group> groups_;
  std::vector<GapSampler> samplers_;
  std::vector<SymmetryPlane> common_planes_, planes_;  // of both bodies; those of them that cut the overlap
  double area_ = 0, force_ = 0, cell_ = 0, nearest_ = 1e300, modulus_ = 0;
  double slice_ = 0;  // of a quadtree, m
};

}  // namespace

void narrow_to_overlap(const SolvedState& state, std::size_t pair, ZoneState& zone) {
  const std::vector<Group> groups = groups_of(state, pair);
  const auto joined = [&](int i, int k, double cells = max_group_spacing) {
    return (groups[i].centre - groups[k].centre).norm() <=
           cells * std::max(groups[i].group->larger_cell, groups[k].group->larger_cell);
  };
  double reach = 0;
  std::vector<int> closed;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!groups[g].closed) continue;
    closed.push_back(static_cast<int>(g));
    reach = std::max(reach, max_group_spacing * groups[g].group->larger_cell);
  }
  const std::vector<int> set = connected_sets(
      closed.size(), reach, [&](std::size_t i) { return groups[closed[i]].centre; },
      [&](int i, int k) { return joined(closed[i], closed[k]); });
  std::vector<SizedBall> balls;
  double narrowest = 1e300;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    if (set[i] != static_cast<int>(i)) continue;
    std::vector<Group> members;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (std::size_t k = 0; k < closed.size(); ++k)
        if (set[k] == static_cast<int>(i) && joined(static_cast<int>(g), closed[k], around)) {
          members.push_back(groups[g]);
          break;
        }
    Overlap overlap(state, pair, members);
    const std::vector<GapSample> samples = overlap.samples();
    if (samples.empty()) return;
    narrowest = std::min(narrowest, overlap.width(samples));
    for (const GapSample& s : samples) balls.push_back({s.x, overlap.reach(s), 0});
  }
  if (balls.empty()) return;
  zone.balls = std::move(balls);
  zone.width = narrowest;
  zone.narrowed = true;
}

}  // namespace cgcontact
