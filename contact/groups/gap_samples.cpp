#include "contact/groups/gap_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "contact/model/opposite_points.hpp"

namespace cgcontact {
namespace {

/// Leaves over a side of the first grid, four samples each.
constexpr int first_leaves = 4;
/// Change of the distance over a quarter of a leaf, of the depth below the limit, that need not be resolved.
constexpr double resolved_fraction = 0.1;
/// Cells: depths below this are not looked for.
constexpr double min_depth = 1e-5;
constexpr int max_levels = 14;
constexpr std::size_t max_leaves = 8192;

/// Square of the plane across the group's mean normal, with the samples in the middles of its quarters.
struct SampleLeaf {
  double s = 0, t = 0, size = 0;  ///< centre and side, m
  struct Sample {
    bool hit = false;                ///< both bodies
    bool inside = false;             ///< of the group's surface, in its cell
    double distance = 0, slope = 0;  ///< m; of the distance over the plane
    Vec3 x;
  } samples[4];
  double lower_bound = 1e300;  ///< no distance in the leaf is below this
  double change = 0;           ///< largest distance from a sample to a position that it stands for

  void see(const Sample& sample, double reach) {
    if (!sample.hit) return;
    lower_bound = std::min(lower_bound, sample.distance - sample.slope * reach);
    change = std::max(change, sample.slope * reach);
  }
};

/// Returns the gradient of the height of a surface with normal m over the plane with normal n.
Vec3 height_gradient(const Vec3& m, const Vec3& n) { return -(m - m.dot(n) * n) / m.dot(n); }

class LeafSampler {
 public:
  LeafSampler(const std::vector<BodyModel>& bodies, const ContactPair& pair, const ContactGroup& group)
      : bodies_(bodies),
        pair_(pair),
        group_(group),
        primary_(bodies[pair.primary]),
        cells_(bodies[group.body].cut_cells) {
    const Grid& grid = cells_.grid;
    Vec3 normal = Vec3::Zero(), mean = Vec3::Zero();
    for (int q = group.first_point; q < group.last_point; ++q) {
      normal += pair.points.weight(q) * pair.points.normal(q);
      mean += pair.points.weight(q) / group.area * pair.points.x(q);
    }
    normal_ = normal.normalized();
    const Vec3 middle = global_position(cells_, group.cell, Vec3::Zero());
    centre_ = middle + (mean - middle).dot(normal_) * normal_;
    // Along the grid, so that leaves end where the cell does if its face is parallel to a grid plane.
    Eigen::Index across;
    (grid.rotation.transpose() * normal_).cwiseAbs().minCoeff(&across);
    along_s_ = (grid.rotation.col(across) - grid.rotation.col(across).dot(normal_) * normal_).normalized();
    along_t_ = normal_.cross(along_s_);
    side_ = 2 * group.larger_cell;  // covers the cell in any direction
    if (grid.is_quadtree()) {
      along_s_ = Vec3::Unit(grid.plane_strain);
      along_t_ = normal_.cross(along_s_);
      widest_ = 0.5 * group.larger_cell;
      area_factor_ = grid.slice / group.larger_cell * grid.ring(grid.to_grid(mean));
    }
  }

  SampleLeaf leaf(double s, double t, double size) const {
    SampleLeaf l{s, t, size, {}};
    for (int k = 0; k < 4; ++k)
      l.samples[k] = sample(s + ((k & 1) - 0.5) * 0.5 * size, t + ((k >> 1) - 0.5) * 0.5 * size);
    const bool all = std::all_of(l.samples, l.samples + 4, [](const SampleLeaf::Sample& sample) { return sample.hit; });
    // To the farthest point of its quarter, or of the leaf where other samples miss the bodies: there an edge or a tip
    // ends, and what lies beside the leaf gives the depth.
    for (const SampleLeaf::Sample& sample : l.samples) l.see(sample, (all ? 1 : 3) * size * std::sqrt(2.0) / 4);
    if (all) return l;
    for (int k = 0; k < 16; ++k) {
      const int i = k % 4, j = k / 4;
      if ((i == 1 || i == 2) && (j == 1 || j == 2)) continue;
      l.see(sample(s + (i - 1.5) * 0.5 * size, t + (j - 1.5) * 0.5 * size), 5 * size * std::sqrt(2.0) / 4);
    }
    return l;
  }
  double side() const { return side_; }
  double area(const SampleLeaf& leaf) const { return 0.25 * area_factor_ * leaf.size * leaf.size; }
  /// Returns whether the leaf may lie in the group's cell.
  bool may_hold(const SampleLeaf& leaf) const {
    const Grid& grid = cells_.grid;
    const double reach = leaf.size / std::sqrt(2.0) / group_.larger_cell;  // all in cells
    // A surface may lie above or below the plane: the distance across it does not count.
    const Vec3 normal = grid.rotation.transpose() * normal_;
    const Vec3 xi =
        cell_coordinates(cells_, group_.cell, grid.to_grid(centre_ + leaf.s * along_s_ + leaf.t * along_t_));
    for (int k = 0; k < 3; ++k)
      if (std::abs(xi[k]) > 1 + 2 * (reach + std::sqrt(3.0) * std::abs(normal[k]))) return false;
    return true;
  }
  /// Position of a contact point in the plane, m.
  using PlanePoint = std::array<double, 2>;
  std::vector<PlanePoint> points() const {
    std::vector<PlanePoint> points;
    for (int q = group_.first_point; q < group_.last_point; ++q) {
      const Vec3 r = pair_.points.x(q) - centre_;
      points.push_back({r.dot(along_s_), r.dot(along_t_)});
    }
    return points;
  }
  /// Returns the distance of the group's points in the mean, m.
  double spacing() const {
    const double area = group_.area / area_factor_ / (group_.last_point - group_.first_point);
    return is_line() ? area / group_.larger_cell : std::sqrt(area);
  }
  /// Returns whether a point lies in a leaf; on a quadtree at any s.
  bool holds(const SampleLeaf& leaf, const PlanePoint& point) const {
    return std::abs(point[1] - leaf.t) <= 0.5 * leaf.size &&
           (is_line() || std::abs(point[0] - leaf.s) <= 0.5 * leaf.size);
  }

 private:
  bool is_line() const { return widest_ < 1e300; }

  SampleLeaf::Sample sample(double s, double t) const {
    SampleLeaf::Sample result;
    const Grid& grid = primary_.cut_cells.grid;
    const Solid& solid = primary_.cut_cells.solid;
    const Vec3 start = grid.to_grid(centre_ + s * along_s_ + t * along_t_);
    const Vec3 direction = grid.rotation.transpose() * normal_;
    static thread_local std::vector<Crossing> crossings;
    crossings.clear();
    solid.crossings(start, direction, side_ / grid.cell_size, crossings);
    std::optional<Crossing> own;
    bool inside = false;
    for (const Crossing& c : crossings) {
      // Other surfaces of the face, too: beside an edge or a corner they show how deep the group's own one may lie.
      if (c.normal.dot(direction) < min_facing_cosine) continue;
      if (own && std::abs(c.t) >= std::abs(own->t)) continue;
      const Vec3 y = start + c.t * direction;
      if (!pair_.face(pair_.primary)
               .contains(solid.surfaces()[c.surface].names, grid.to_global(y), grid.rotation * c.normal))
        continue;
      own = c;
      inside = c.surface == group_.surface && std::abs(s) < widest_ &&
               (group_.body != pair_.primary || primary_.cut_cells.locate(y - inward_step * c.normal) == group_.cell);
    }
    if (!own) return result;
    result.x = grid.to_global(start + own->t * direction);
    const auto opposite = find_opposite(bodies_, pair_, pair_.primary, result.x, normal_);
    if (!opposite) return result;
    result.hit = true;
    result.inside = inside && (group_.body == pair_.primary || opposite->cell == group_.cell);
    result.distance = opposite->distance;
    result.slope =
        (height_gradient(opposite->normal, normal_) - height_gradient(grid.rotation * own->normal, normal_)).norm();
    return result;
  }

  const std::vector<BodyModel>& bodies_;
  const ContactPair& pair_;
  const ContactGroup& group_;
  const BodyModel& primary_;
  const CutCells& cells_;  ///< of the body that the group's cell is of
  Vec3 normal_, centre_, along_s_, along_t_;
  double side_ = 0;
  /// On a quadtree, where nothing varies along s: samples within a cell stand for the slice.
  double widest_ = 1e300, area_factor_ = 1;
};

}  // namespace

class GapSampler::Impl {
 public:
  Impl(const std::vector<BodyModel>& bodies, const ContactPair& pair, const ContactGroup& group)
      : sampler_(bodies, pair, group), group_(group), points_(sampler_.points()), spacing_(sampler_.spacing()) {}

  std::vector<GapSample> samples(double limit);

 private:
  /// Square of the grid of a level; the first has first_leaves of them along a side.
  struct LeafIndex {
    int level, i, j;
    std::uint64_t key() const {
      return std::uint64_t(level) << 56 | std::uint64_t(i) << 28 | static_cast<std::uint64_t>(j);
    }
  };

  /// Returns whether points lie in a leaf whose samples see nothing opposite: what the points see is between these.
  bool is_between_samples(const SampleLeaf& leaf) const {
    return leaf.lower_bound == SampleLeaf().lower_bound && spacing_ < 0.5 * leaf.size &&
           std::any_of(points_.begin(), points_.end(), [&](const auto& point) { return sampler_.holds(leaf, point); });
  }

  const SampleLeaf& leaf(const LeafIndex& index) {
    const auto [found, is_new] = leaves_.try_emplace(index.key());
    if (is_new) {
      const double size = std::ldexp(sampler_.side() / first_leaves, -index.level);
      found->second = sampler_.leaf((index.i + 0.5) * size - 0.5 * sampler_.side(),
                                    (index.j + 0.5) * size - 0.5 * sampler_.side(), size);
    }
    return found->second;
  }

  LeafSampler sampler_;
  const ContactGroup& group_;
  std::vector<LeafSampler::PlanePoint> points_;
  double spacing_;
  std::unordered_map<std::uint64_t, SampleLeaf> leaves_;
};

std::vector<GapSample> GapSampler::Impl::samples(double limit) {
  std::vector<LeafIndex> indices;
  for (int i = 0; i < first_leaves; ++i)
    for (int j = 0; j < first_leaves; ++j) indices.push_back({0, i, j});
  double smallest = 1e300;
  const auto look = [&](const SampleLeaf& leaf) {
    for (const SampleLeaf::Sample& sample : leaf.samples)
      if (sample.inside) smallest = std::min(smallest, sample.distance);
  };
  for (const LeafIndex& index : indices) look(leaf(index));
  for (int level = 0; level < max_levels; ++level) {
    const double depth = std::max(limit - smallest, min_depth * group_.larger_cell);
    const auto fine = [&](const LeafIndex& index) {
      const SampleLeaf& square = leaf(index);
      if (is_between_samples(square)) return false;
      return square.lower_bound >= limit || !sampler_.may_hold(square) || square.change <= resolved_fraction * depth;
    };
    const std::size_t coarse = indices.size() - std::count_if(indices.begin(), indices.end(), fine);
    // All or none: a strip that is finer at one end would count for less at the other.
    if (coarse == 0 || indices.size() + 3 * coarse > max_leaves) break;
    std::vector<LeafIndex> finer;
    for (const LeafIndex& index : indices) {
      if (fine(index)) {
        finer.push_back(index);
        continue;
      }
      for (int k = 0; k < 4; ++k) {
        finer.push_back({index.level + 1, 2 * index.i + (k & 1), 2 * index.j + (k >> 1)});
        look(leaf(finer.back()));
      }
    }
    indices.swap(finer);
  }
  std::vector<GapSample> samples;
  if (!(smallest < limit)) return samples;
  for (const LeafIndex& index : indices) {
    const SampleLeaf& square = leaf(index);
    for (const SampleLeaf::Sample& sample : square.samples)
      if (sample.inside) samples.push_back({sample.x, sampler_.area(square), sample.distance});
  }
  return samples;
}

GapSampler::GapSampler(const std::vector<BodyModel>& bodies, const ContactPair& pair, const ContactGroup& group)
    : impl_(std::make_unique<Impl>(bodies, pair, group)) {}
GapSampler::GapSampler(GapSampler&&) noexcept = default;
GapSampler::~GapSampler() = default;
std::vector<GapSample> GapSampler::samples(double limit) { return impl_->samples(limit); }

std::vector<GapSample> sample_gap(const std::vector<BodyModel>& bodies, const ContactPair& pair,
                                  const ContactGroup& group, double limit) {
  return GapSampler(bodies, pair, group).samples(limit);
}

}  // namespace cgcontact
