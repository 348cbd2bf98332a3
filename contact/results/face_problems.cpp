#include "contact/results/face_problems.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "contact/model/indentation.hpp"
#include "core/base/parallel.hpp"
#include "core/base/point_buckets.hpp"
#include "recovery/face/far_field.hpp"
#include "recovery/zone_edge/connected_sets.hpp"

namespace cgcontact {
namespace {

/// Zones whose closed groups are so many cells farther apart than the reach of a problem have problems of their own.
constexpr double apart = 1;
/// Part of a cell: a place is part of a face when a contact point is as near as that.
constexpr double point_spacing = 0.7;
/// A place at the border of a cell is in it, part of the cell.
constexpr double same_cell = 1e-6;
/// Places along a cell, and along a patch at least, that are looked at for whose they are.
constexpr int samples_per_cell = 48, min_samples = 4;
/// Pressure is at most so many cells beyond the closed groups: they close when their mean gap does.
constexpr double beyond_closed = 1.25;
/// Per cell, along a zone that goes on behind symmetry planes at both ends.
constexpr int patches_along = 2;
/// A whole zone has fewer patches per cell when it has more patches than that, some 100 across: more gain nothing
/// (docs/accuracy.md). At fewer than min_per_cell the borders of the groups are lost among them.
constexpr double most_patches = 8192;
constexpr int min_per_cell = 5;
/// Length of the details of a face made of triangles, in facets: waves as long as a facet are a thousandth as high with
/// it, (2 pi / 2)^-6.
constexpr double facet_details = 0.5;
/// Radians between triangles from which on they are facets of something round: rounding of files makes less.
constexpr double least_angle = 1e-4;
/// Part of a zone's force that decides nothing.
constexpr double relevant_part = 0.01;
/// Zones that have more even so, some 90 cells across, keep the pressure of the stress, which is accurate there.
constexpr double too_many_patches = 262144;

/// A contact group with what its points say, m, N.
struct Group {
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double area = 0, force = 0, gap_change = 0, larger = 0;
  bool closed() const { return force > 0; }
};

/// One pair's points and groups.
class PairFace {
 public:
  PairFace(const SolvedState& state, int pair, const double* group_force)
      : pair_(state.pairs[pair]), groups_(pair_.groups.size()) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      groups_[g].force = force_unit(state) * group_force[g];
      groups_[g].larger = pair_.groups[g].larger_cell;
    }
    std::vector<double> change(pair_.points.size());
    parallel_for("cgcontact::face_problems::gaps", pair_.points.size(), 256, [&](std::size_t q) {
      const ContactPoint p = pair_.points[q];
      const Vec3 relative = displacement(state, pair_.secondary, p.secondary_cell, p.secondary_xi) -
                            displacement(state, pair_.primary, p.primary_cell, p.primary_xi);
      change[q] = relative.dot(p.normal);
    });
    for (std::size_t q = 0; q < pair_.points.size(); ++q) {
      Group& group = groups_[pair_.points.group(q)];
      const double w = pair_.points.weight(q);
      group.area += w;
      group.centre += w * pair_.points.x(q);
      group.normal += w * pair_.points.normal(q);
      group.gap_change += w * change[q];
    }
    for (Group& group : groups_) {
      if (!(group.area > 0)) continue;
      group.centre /= group.area;
      group.normal.normalize();
      group.gap_change /= group.area;
    }
  }
  const std::vector<Group>& groups() const { return groups_; }
  const ContactPair& pair() const { return pair_; }

  /// Closed groups of each zone.
  std::vector<std::vector<int>> zones(double reach) const {
    std::vector<int> closed;
    double largest = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (groups_[g].closed() && groups_[g].area > 0) {
        closed.push_back(static_cast<int>(g));
        largest = std::max(largest, groups_[g].larger);
      }
    if (closed.empty()) return {};
    const double span = reach + apart;
    const std::vector<int> first = connected_sets(
        closed.size(), span * largest, [&](std::size_t i) { return groups_[closed[i]].centre; },
        [&](int i, int k) {
          const Group &a = groups_[closed[i]], &b = groups_[closed[k]];
          return (a.centre - b.centre).norm() < span * std::max(a.larger, b.larger) &&
                 a.normal.dot(b.normal) > same_side;
        });
    std::vector<std::vector<int>> zones;
    std::vector<int> number(closed.size(), -1);
    for (std::size_t i = 0; i < closed.size(); ++i) {
      if (first[i] == static_cast<int>(i)) {
        number[i] = static_cast<int>(zones.size());
        zones.emplace_back();
      }
      zones[number[first[i]]].push_back(closed[i]);
    }
    return zones;
  }

 private:
  const ContactPair& pair_;
  std::vector<Group> groups_;
};

/// Planes that both bodies have; a rigid body needs none.
std::vector<SymmetryPlane> planes_of(const SolvedState& state, const ContactPair& pair) {
  std::vector<std::vector<SymmetryPlane>> of_body;
  for (const int body : {pair.primary, pair.secondary})
    if (const BodyModel& model = state.bodies[body]; !model.spec->rigid())
      of_body.push_back(symmetry_planes(model.cut_cells, model.boundary));
  if (of_body.empty()) return {};
  if (of_body.size() == 1) return of_body[0];
  return common_planes(of_body[0], of_body[1], state.bodies[pair.primary].cut_cells.grid.cell_size);
}

/// A zone on its way to a problem.
class ZoneBuilder {
 public:
  ZoneBuilder(const SolvedState& state, const PairFace& face, const std::vector<int>& closed,
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
  }

  /// None: the zone has no problem of this kind.
  std::optional<SolvedZone> solve(const ExecSpace& exec) {
    if (!gather_points()) return std::nullopt;
    std::vector<FacePoint> points;
    for (const int q : near_)
      if (is_closed(q)) points.push_back({pair_.points.x(q), pair_.points.normal(q), pair_.points.weight(q)});
    chart_ = FaceChart::make(points, planes_, across_, state_.bodies[pair_.primary].cut_cells.grid.rotation);
    if (!chart_) return std::nullopt;
    if (!lay_grid()) return std::nullopt;
    assign_points();
    place_patches();
    FaceZone zone = make_zone();
    if (zone.shares.empty() || reaches_end(zone)) return std::nullopt;
    smooth_facets(zone);
    SolvedZone solved{static_cast<int>(&pair_ - state_.pairs.data()), pair_.primary, *chart_, h_, {}, {}, {}};
    solved.known = zone.inside;
    solved.cosine = cosine_;
    solved.pressure = solve_face_zone(exec, zone, options_);
    return solved;
  }

 private:
  bool is_closed(int q) const { return face_.groups()[pair_.points.group(q)].closed(); }

  /// Points within reach of the closed ones on their side of the body; false if all are closed: nothing says where the
  /// zone ends.
  bool gather_points() {
    const double reach = options_.reach * h_;
    PointBuckets buckets(reach);
    std::vector<char> mine(face_.groups().size(), 0);
    for (const int g : closed_) mine[g] = 1;
    for (std::size_t q = 0; q < pair_.points.size(); ++q)
      if (mine[pair_.points.group(q)]) buckets.add(pair_.points.x(q), static_cast<int>(q));
    bool open = false;
    for (std::size_t q = 0; q < pair_.points.size(); ++q) {
      const Vec3 x = pair_.points.x(q), n = pair_.points.normal(q);
      bool near = false;
      buckets.each_near(x, [&](int k) {
        near = near || ((pair_.points.x(k) - x).norm() < reach && pair_.points.normal(k).dot(n) > same_side);
      });
      if (!near) continue;
      near_.push_back(static_cast<int>(q));
      open = open || !is_closed(static_cast<int>(q));
    }
    return open;
  }

  /// Adds up the closed groups, m^2; in plane strain m.
  double zone_area() const {
    double area = 0;
    for (const int g : closed_) area += face_.groups()[g].area;
    return area / thickness_;
  }
  /// Rounds up to what solve_face_zone can halve.
  static int even(double count) {
    const int n = std::max(1, static_cast<int>(count));
    return n < 16 ? n : (n + 7) / 8 * 8;
  }

  /// False: the zone is so wide that its problem would take longer than the bodies'.
  bool lay_grid() {
    grid_.plane_strain = across_ >= 0;
    grid_.end = chart_->ends();
    FacePlace low = FacePlace::Constant(1e300), high = FacePlace::Constant(-1e300);
    for (const int q : near_) {
      const FacePlace x = chart_->place(pair_.points.x(q));
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
      if (patches <= most_patches || per_cell < 2 * min_per_cell) return patches <= too_many_patches;
    }
  }

  Vec3 flat(FacePlace x) const { return {grid_.plane_strain ? 0.0 : x[0], x[1], 0}; }

  /// Finds the contact point nearest to each patch.
  void assign_points() {
    points_.emplace(point_spacing * h_);
    for (const int q : near_) {
      places_.push_back(flat(chart_->place(pair_.points.x(q))));
      points_->add(places_.back(), static_cast<int>(places_.size() - 1));
    }
    nearest_.assign(grid_.num_patches(), -1);
    parallel_for("cgcontact::face_problems::nearest", nearest_.size(), 256, [&](std::size_t n) {
      const Vec3 x = flat(grid_.centre(static_cast<int>(n)));
      double least = point_spacing * h_;
      points_->each_near(x, [&](int k) {
        const double distance = (places_[k] - x).norm();
        if (distance < least) least = distance, nearest_[n] = near_[k];
      });
    });
  }

  /// Groups with points near a patch, those with the nearest one first.
  std::vector<int> groups_near(int patch) const {
    const Vec3 at = flat(grid_.centre(patch));
    std::vector<std::pair<double, int>> found;
    points_->each_near(at, [&](int k) {
      const double distance = (places_[k] - at).norm();
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

  /// Tells whether a place of the face, given those of both bodies there, is in the cell of a group.
  bool holds(int g, const Vec3& primary, const Vec3& secondary) const {
    const ContactGroup& group = pair_.groups[g];
    const CutCells& cc = state_.bodies[group.body].cut_cells;
    const Vec3 inside =
        ((group.body == pair_.primary ? primary : secondary) - cc.corner(group.cell)) / cc.size(group.cell);
    return inside.minCoeff() >= -same_cell && inside.maxCoeff() <= 1 + same_cell;
  }

  /// Parts of a patch by the groups whose cells hold some places spread over it; of several the nearest, where none
  /// does the nearest as well.
  std::vector<std::pair<int, double>> shares_of(int patch, const FacePlace& place, const Vec3& x,
                                                const OppositePoint& opposite) const {
    std::vector<std::pair<int, double>> shares;
    const std::vector<int> groups = groups_near(patch);
    if (groups.empty()) return shares;
    const Grid& own = state_.bodies[pair_.primary].cut_cells.grid;
    const Grid& other = state_.bodies[pair_.secondary].cut_cells.grid;
    const Vec3 middle = chart_->point(place), across = other.to_global(opposite.position);
    const int samples = std::max(min_samples, static_cast<int>(samples_per_cell * grid_.spacing[1] / h_)),
              rows = grid_.plane_strain ? 1 : samples;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < samples; ++j) {
        const FacePlace step((grid_.plane_strain ? 0 : (i + 0.5) / rows - 0.5) * grid_.spacing[0],
                             ((j + 0.5) / samples - 0.5) * grid_.spacing[1]);
        const Vec3 shift = chart_->point(place + step) - middle;
        const Vec3 primary = own.to_grid(x + shift), secondary = other.to_grid(across + shift);
        const auto holding =
            std::find_if(groups.begin(), groups.end(), [&](int g) { return holds(g, primary, secondary); });
        const int g = holding == groups.end() ? groups.front() : *holding;
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
  void place_patches() {
    const BodyModel& body = state_.bodies[pair_.primary];
    const Grid& grid = body.cut_cells.grid;
    const Solid& solid = body.cut_cells.solid;
    distance_.assign(nearest_.size(), 0.0);
    cosine_.assign(nearest_.size(), 1.0);
    height_ = {distance_, distance_};
    shares_.assign(nearest_.size(), {});
    parallel_for("cgcontact::face_problems::distances", nearest_.size(), 16, [&](std::size_t n) {
      if (nearest_[n] < 0) return;
      const int q = nearest_[n];
      FacePlace place = grid_.centre(static_cast<int>(n));
      const Vec3 near = pair_.points.x(q), near_normal = pair_.points.normal(q);
      if (grid_.plane_strain) place[0] = chart_->place(near)[0];
      Vec3 x = chart_->point(place);
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
        x -= surface.signed_distance(g) * grid.cell_size / slope * up;
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
      shares_[n] = shares_of(static_cast<int>(n), place, x, *opposite);
    });
  }

  /// Tells whether the zone transmits forces where a face ends, in groups with the end along half a cell or more:
  /// bodies are no half-spaces there.
  bool reaches_end(const FaceZone& zone) const {
    std::vector<double> end(zone.groups.size(), 0.0);  // m, of the face within each group
    for (const FaceShare& share : zone.shares) {
      if (!(zone.groups[share.group].force > 0)) continue;
      for (int a = grid_.plane_strain ? 1 : 0; a < 2; ++a)
        for (const int step : {-1, 1}) {
          std::array<int, 2> steps{0, 0};
          steps[a] = step;
          const int next = grid_.beyond(share.patch, steps);
          if (next < 0 || shares_[next].empty())
            end[share.group] += share.part * (grid_.plane_strain ? h_ : grid_.spacing[1 - a]);
        }
    }
    double at_end = 0, force = 0;
    for (std::size_t g = 0; g < zone.groups.size(); ++g) {
      force += zone.groups[g].force;
      if (end[g] >= h_ / 2) at_end += zone.groups[g].force;
    }
    return at_end > relevant_part * force;
  }

  /// Width of the widest facets of a body where it touches, m; 0: it is not made of triangles there.
  double widest_facet(int body) const {
    const CutCells& cells = state_.bodies[body].cut_cells;
    double widest = 0;
    for (const int q : near_) {
      if (!is_closed(q)) continue;
      const ContactPoint point = pair_.points[q];
      const Vec3& position = body == pair_.primary ? point.primary_position : point.secondary_position;
      widest = std::max(widest, cells.grid.cell_size * cells.solid.geometry().facet_width(position, least_angle));
    }
    return widest;
  }

  /// Patches are finer than triangles, whose edges are no part of the body that they stand for: its face has no details
  /// shorter than the widest facets.
  void smooth_facets(FaceZone& zone) const {
    const double patch = grid_.plane_strain ? grid_.spacing[1] : std::min(grid_.spacing[0], grid_.spacing[1]);
    for (const int body : {pair_.primary, pair_.secondary}) {
      const double facet = widest_facet(body);
      if (facet <= patch) continue;
      const std::vector<double>& height = height_[body == pair_.primary ? 0 : 1];
      std::vector<FarMean> heights;
      for (int n = 0; n < grid_.num_patches(); ++n)
        if (zone.inside[n]) heights.push_back({{{n, 1.0}}, height[n], 1, 1});
      const std::vector<double> smooth = FarField(grid_, facet, zone.inside, heights).with_details(facet_details);
      const double side = body == pair_.primary ? -1 : 1;
      for (int n = 0; n < grid_.num_patches(); ++n)
        if (zone.inside[n]) zone.distance[n] += side * cosine_[n] * (smooth[n] - height[n]);
    }
  }

  FaceZone make_zone() const {
    FaceZone zone;
    zone.grid = grid_;
    zone.h = h_;
    zone.modulus =
        effective_modulus(state_.bodies[pair_.primary].spec->material, state_.bodies[pair_.secondary].spec->material);
    zone.distance = distance_;
    zone.may_press.assign(nearest_.size(), 0);
    PointBuckets closed_points(beyond_closed * h_);
    for (std::size_t k = 0; k < near_.size(); ++k)
      if (is_closed(near_[k])) closed_points.add(places_[k], static_cast<int>(k));
    std::vector<int> number(face_.groups().size(), -1);
    const auto add = [&](int g) {
      if (number[g] >= 0) return;
      number[g] = static_cast<int>(zone.groups.size());
      const Group& group = face_.groups()[g];
      double away = group.closed() ? 0 : 1e300;
      for (const int closed : closed_)
        if (!group.closed()) away = std::min(away, (face_.groups()[closed].centre - group.centre).norm());
      zone.groups.push_back({group.area / thickness_, group.force / thickness_, group.gap_change, away});
    };
    for (const int g : closed_) add(g);
    for (std::size_t n = 0; n < nearest_.size(); ++n) {
      // What another zone transmits is not this one's.
      const bool mine = std::none_of(shares_[n].begin(), shares_[n].end(), [&](const auto& share) {
        return face_.groups()[share.first].closed() && number[share.first] < 0;
      });
      zone.inside.push_back(!shares_[n].empty() && mine);
      if (!zone.inside.back()) continue;
      for (const auto& [g, part] : shares_[n]) {
        add(g);
        zone.shares.push_back({static_cast<int>(n), number[g], part});
      }
      const Vec3 x = flat(grid_.centre(static_cast<int>(n)));
      closed_points.each_near(x, [&](int k) {
        if ((places_[k] - x).norm() < beyond_closed * h_) zone.may_press[n] = 1;
      });
    }
    return zone;
  }

  const SolvedState& state_;
  const PairFace& face_;
  const ContactPair& pair_;
  const std::vector<int>& closed_;
  const FaceOptions& options_;
  double h_ = 0, thickness_ = 1;
  int across_ = -1;
  std::vector<SymmetryPlane> planes_;
  std::vector<int> near_;  ///< contact points of the zone
  std::optional<FaceChart> chart_;
  FaceGrid grid_;
  std::optional<PointBuckets> points_;  ///< near_, by places_
  std::vector<Vec3> places_;            ///< coordinates of near_
  std::vector<int> nearest_;            ///< contact point nearest to each patch; -1: it is no part of the faces
  std::vector<std::vector<std::pair<int, double>>> shares_;  ///< groups of each patch and their parts of it
  std::vector<double> distance_, cosine_;                    ///< m; between the normals of the face and of the chart
  std::array<std::vector<double>, 2> height_;  ///< of the primary and of the opposite face above the chart, m
};

}  // namespace

FacePressures solve_face_pressures(const ExecSpace& exec, const SolvedState& state) {
  FacePressures result;
  const FaceOptions& options = state.scene.recovery.face;
  std::size_t first_group = 0;
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const ContactPair& pair = state.pairs[p];
    result.left_out.push_back(0);
    if (!pair.bonded()) {
      const PairFace face(state, static_cast<int>(p), state.outer.group_force.data() + first_group);
      const std::vector<SymmetryPlane> planes = planes_of(state, pair);
      for (const std::vector<int>& closed : face.zones(options.reach)) {
        auto zone = ZoneBuilder(state, face, closed, planes, options).solve(exec);
        if (zone)
          result.zones.push_back(std::move(*zone));
        else
          ++result.left_out.back();
      }
    }
    first_group += pair.groups.size();
  }
  return result;
}

}  // namespace cgcontact
