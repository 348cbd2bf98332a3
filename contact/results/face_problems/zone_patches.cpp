#include "contact/results/face_problems/zone_patches.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/process/parallel.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {
namespace {

/// Fraction of a cell: a point is on a face when a contact point is as near as that.
constexpr double point_spacing = 0.7;
/// Fraction of a cell: a point this near to the border of a cell is in it.
constexpr double cell_border = 1e-6;
/// Fraction of a cell: a point that moves by less is on the surface, and its normal that of the surface there.
constexpr double on_surface = 1e-9;
/// Samples along a cell, and along a patch at least, to find the groups that they belong to.
constexpr int samples_per_cell = 48, min_samples = 4;
/// Per cell, along a zone that goes on behind symmetry planes at both ends.
constexpr int patches_along = 2;
/// A whole zone has fewer patches per cell when it has more patches than that, some 100 across: more gain nothing
/// (docs/recovery.md). At fewer than min_per_cell the borders of the groups are lost among them.
constexpr double max_patches = 8192;
constexpr int min_per_cell = 5;
/// Zones that have more even so, some 90 cells across, keep the pressure of the stress, which is accurate there.
constexpr double too_many_patches = 262144;
/// The same of rings, whose compliance is a dense matrix.
constexpr double max_rings = 1024, too_many_rings = 2048;

/// Rounds up to what solve_face_zone can halve.
int even(double count) {
  const int n = std::max(1, static_cast<int>(count));
  return n < 16 ? n : (n + 7) / 8 * 8;
}

}  // namespace

ZonePatches::ZonePatches(const SolvedState& state, const PairGroups& face, const std::vector<int>& closed,
                         const std::vector<SymmetryPlane>& planes, const FaceOptions& options)
    : state_(state), face_(face), pair_(face.pair()), closed_(closed), options_(options) {
  std::vector<double> sizes;
  for (const int g : closed) sizes.push_back(face.groups()[g].larger);
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  h_ = sizes[sizes.size() / 2];
  const Grid& grid = state.bodies[pair_.primary].cut_cells.grid;
  across_ = grid.is_quadtree() ? grid.plane_strain : -1;
  thickness_ = across_ >= 0 ? grid.slice : 1;
  for (const SymmetryPlane& plane : planes) {
    if (across_ >= 0 && std::abs(plane.normal[across_]) > 0.5) continue;
    double nearest = 1e300;
    for (const int g : closed) nearest = std::min(nearest, std::abs(plane.distance(face.groups()[g].centre)));
    if (nearest < h_) planes_.push_back(plane);
  }
  for (const ContactGroup& group : pair_.groups) {
    const CutCells& cc = state.bodies[group.body].cut_cells;
    const Vec3 border = Vec3::Constant(cell_border * cc.size(group.cell)), low = cc.corner(group.cell);
    cells_.push_back({low - border, low + Vec3::Constant(cc.size(group.cell)) + border, group.body == pair_.primary});
  }
}

std::optional<ZonePatches> ZonePatches::make(const SolvedState& state, const PairGroups& face,
                                             const std::vector<int>& closed, const std::vector<SymmetryPlane>& planes,
                                             const FaceOptions& options) {
  ZonePatches patches(state, face, closed, planes, options);
  if (!patches.gather_points()) return std::nullopt;
  std::vector<FacePoint> points;
  for (const int q : patches.near_)
    if (patches.is_closed(q))
      points.push_back({patches.pair_.points.x(q), patches.pair_.points.normal(q), patches.pair_.points.weight(q)});
  patches.chart_ = ZoneChart::make(points, patches.planes_, patches.across_,
                                   state.bodies[patches.pair_.primary].cut_cells.grid.rotation);
  if (!patches.chart_ || !patches.lay_grid()) return std::nullopt;
  patches.lay_meridian();
  patches.assign_points();
  patches.project_patches();
  return patches;
}

/// Finds points within reach of the closed ones on their side of the body; false if all are closed: the zone's end is
/// unknown.
bool ZonePatches::gather_points() {
  const double reach = options_.reach * h_;
  PointBuckets buckets(reach);
  std::vector<char> mine(face_.groups().size(), 0);
  for (const int g : closed_) mine[g] = 1;
  for (std::size_t q = 0; q < pair_.points.size(); ++q)
    if (mine[pair_.points.group(q)]) buckets.add(pair_.points.x(q), static_cast<int>(q));
  bool open = false;
  for (std::size_t q = 0; q < pair_.points.size(); ++q) {
    const Vec3 x = pair_.points.x(q), n = pair_.points.normal(q);
    const bool near = mine[pair_.points.group(q)] || buckets.any_near(x, [&](int k) {
      return (pair_.points.x(k) - x).norm() < reach && pair_.points.normal(k).dot(n) > same_side;
    });
    if (!near) continue;
    near_.push_back(static_cast<int>(q));
    open = open || !is_closed(static_cast<int>(q));
  }
  return open;
}

/// Adds up the closed groups, m^2; in plane strain m.
double ZonePatches::zone_area() const {
  double area = 0;
  for (const int g : closed_) area += face_.groups()[g].area;
  return area / thickness_;
}

/// False: the zone is so wide that its problem would take longer than the bodies'.
bool ZonePatches::lay_grid() {
  grid_.plane_strain = across_ >= 0;
  grid_.end = chart_->ends();
  FacePosition low = FacePosition::Constant(1e300), high = FacePosition::Constant(-1e300);
  for (const int q : near_) {
    const FacePosition x = chart_->coordinates(pair_.points.x(q));
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double margin = 0.5 * h_;
  for (int per_cell = grid_.plane_strain ? options_.patches_per_cell_2d : options_.patches_per_cell_3d;;
       per_cell /= 2) {
    for (int a = 0; a < 2; ++a) {
      const double begin = grid_.end[a] == FaceEnd::free ? low[a] - margin : 0;
      const double length = grid_.end[a] == FaceEnd::period ? chart_->length(a) : high[a] + margin - begin;
      // A zone between two symmetry planes ends along the axis between them.
      const double spacing = h_ / (grid_.end[a] == FaceEnd::period ? patches_along : per_cell);
      grid_.size[a] = even(std::ceil(length / spacing - 1e-6));
      grid_.spacing[a] = grid_.end[a] == FaceEnd::period ? length / grid_.size[a] : spacing;
      // Mirror images have mirrored patches.
      const bool free = grid_.end[a] == FaceEnd::free;
      grid_.low[a] = begin - (free ? (grid_.size[a] * grid_.spacing[a] - length) / 2 : 0);
    }
    if (grid_.plane_strain) {
      grid_.size[0] = 1;
      grid_.spacing[0] = 1;
      grid_.low[0] = -0.5;
      grid_.end[0] = FaceEnd::free;
    }
    double patches = zone_area() / grid_.area();
    for (const FaceEnd end : grid_.end) patches *= end == FaceEnd::mirror ? 2 : 1;
    const bool rings = state_.bodies[pair_.primary].cut_cells.grid.is_axisymmetric();
    if (rings) patches = grid_.size[1];
    if (patches <= (rings ? max_rings : max_patches) || per_cell < 2 * min_per_cell)
      return patches <= (rings ? too_many_rings : too_many_patches);
  }
}

/// Lays the line that a face around an axis of revolution is made of.
void ZonePatches::lay_meridian() {
  const Grid& grid = state_.bodies[pair_.primary].cut_cells.grid;
  if (!grid.is_axisymmetric()) return;
  auto meridian = std::make_shared<Meridian>();
  meridian->first = grid_.centre(0)[1];
  meridian->spacing = grid_.spacing[1];
  meridian->unit_radius = grid.unit_radius;
  for (int n = 0; n < grid_.num_patches(); ++n) {
    const Vec3 x = chart_->point(grid_.centre(n));
    meridian->points.emplace_back(x[grid.radial_axis()], x[grid.axis_of_revolution()]);
  }
  grid_.meridian = std::move(meridian);
}

/// Finds the contact point nearest to each patch.
void ZonePatches::assign_points() {
  points_.emplace(point_spacing * h_);
  for (const int q : near_) {
    coordinates_.push_back(flat(chart_->coordinates(pair_.points.x(q))));
    points_->add(coordinates_.back(), static_cast<int>(coordinates_.size() - 1));
  }
  nearest_.assign(grid_.num_patches(), -1);
  parallel_for("cgcontact::zone_patches::nearest", nearest_.size(), 256, [&](std::size_t n) {
    const Vec3 x = flat(grid_.centre(static_cast<int>(n)));
    double least = point_spacing * h_;
    points_->each_near(x, [&](int k) {
      const double distance = (coordinates_[k] - x).norm();
      if (distance < least) least = distance, nearest_[n] = near_[k];
    });
  });
}

/// Groups with points near a patch, those with the nearest one first.
std::vector<int> ZonePatches::groups_near(int patch) const {
  const Vec3 at = flat(grid_.centre(patch));
  std::vector<std::pair<double, int>> found;
  points_->each_near(at, [&](int k) {
    const double distance = (coordinates_[k] - at).norm();
    const int g = pair_.points.group(near_[k]);
    const auto known = std::find_if(found.begin(), found.end(), [&](const auto& group) { return group.second == g; });
    if (known == found.end())
      found.emplace_back(distance, g);
    else
      known->first = std::min(known->first, distance);
  });
  std::sort(found.begin(), found.end());
  std::vector<int> groups;
  for (const auto& [distance, g] : found) groups.push_back(g);
  return groups;
}

/// Returns the shares of groups in a patch, by the cells that hold some points spread over it; of several the nearest,
/// where none does the nearest as well.
std::vector<std::pair<int, double>> ZonePatches::shares_of(int patch, const FacePosition& position, const Vec3& x,
                                                           const OppositePoint& opposite) const {
  std::vector<std::pair<int, double>> shares;
  const std::vector<int> groups = groups_near(patch);
  if (groups.empty()) return shares;
  const Grid& own = state_.bodies[pair_.primary].cut_cells.grid;
  const Grid& other = state_.bodies[pair_.secondary].cut_cells.grid;
  const Vec3 middle = chart_->point(position), across = other.to_global(opposite.position);
  const int samples = std::max(min_samples, static_cast<int>(samples_per_cell * grid_.spacing[1] / h_)),
            rows = grid_.plane_strain ? 1 : samples;
  const auto group_at = [&](int i, int j) {
    const FacePosition step((grid_.plane_strain ? 0 : (i + 0.5) / rows - 0.5) * grid_.spacing[0],
                            ((j + 0.5) / samples - 0.5) * grid_.spacing[1]);
    const Vec3 shift = chart_->point(position + step) - middle;
    const Vec3 primary = own.to_grid(x + shift), secondary = other.to_grid(across + shift);
    const auto holding =
        std::find_if(groups.begin(), groups.end(), [&](int g) { return cells_[g].holds(primary, secondary); });
    return holding == groups.end() ? groups.front() : *holding;
  };
  // A cell that holds the corners holds all.
  const auto is_nearest = [&](int i, int j) { return group_at(i, j) == groups.front(); };
  if (is_nearest(0, 0) && is_nearest(0, samples - 1) && is_nearest(rows - 1, 0) && is_nearest(rows - 1, samples - 1))
    return {{groups.front(), 1.0}};
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < samples; ++j) {
      const int g = group_at(i, j);
      const auto known =
          std::find_if(shares.begin(), shares.end(), [&](const auto& share) { return share.first == g; });
      if (known == shares.end())
        shares.emplace_back(g, 1.0 / (rows * samples));
      else
        known->second += 1.0 / (rows * samples);
    }
  return shares;
}

/// Puts every patch onto the primary face and looks across; those beyond the faces drop out.
void ZonePatches::project_patches() {
  const BodyModel& body = state_.bodies[pair_.primary];
  const Grid& grid = body.cut_cells.grid;
  const Solid& solid = body.cut_cells.solid;
  distance_.assign(nearest_.size(), 0.0);
  cosine_.assign(nearest_.size(), 1.0);
  height_ = {distance_, distance_};
  shares_.assign(nearest_.size(), {});
  parallel_for("cgcontact::zone_patches::distances", nearest_.size(), 16, [&](std::size_t n) {
    if (nearest_[n] < 0) return;
    const int q = nearest_[n];
    FacePosition position = grid_.centre(static_cast<int>(n));
    const Vec3 near = pair_.points.x(q), near_normal = pair_.points.normal(q);
    if (grid_.plane_strain) position[0] = chart_->coordinates(near)[0];
    Vec3 x = chart_->point(position);
    const Vec3 up = chart_->normal(x);
    // Onto the tangent plane of the nearest point, then onto the surface.
    x += near_normal.dot(near - x) / near_normal.dot(up) * up;
    const Surface& surface = solid.surfaces()[pair_.groups[pair_.points.group(q)].surface];
    Vec3 normal = near_normal;
    for (int k = 0; k < 3; ++k) {
      const Vec3 g = grid.to_grid(x);
      const Vec3 gradient = grid.rotation * surface.gradient(g);
      normal = gradient.dot(near_normal) < 0 ? Vec3(-gradient) : gradient;
      const double slope = gradient.dot(up);
      if (!(std::abs(slope) > 0.1)) break;
      const double step = surface.signed_distance(g) * grid.cell_size / slope;
      x -= step * up;
      if (std::abs(step) < on_surface * h_) break;
    }
    if (!((x - near).norm() < 2 * point_spacing * h_)) {
      nearest_[n] = -1;
      return;
    }
    const Vec3 inner = grid.to_grid(x - 1e-6 * h_ * normal);
    const auto opposite = solid.contains(inner) ? find_opposite(state_.bodies, pair_, pair_.primary, x, normal)
                                                : std::optional<OppositePoint>();
    if (!opposite) {
      nearest_[n] = -1;
      return;
    }
    distance_[n] = opposite->distance;
    height_[0][n] = chart_->height(x);
    height_[1][n] = chart_->height(state_.bodies[pair_.secondary].cut_cells.grid.to_global(opposite->position));
    cosine_[n] = std::max(normal.dot(up), 0.0);
    shares_[n] = shares_of(static_cast<int>(n), position, x, *opposite);
  });
}

}  // namespace cgcontact
