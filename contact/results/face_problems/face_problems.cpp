#include "contact/results/face_problems/face_problems.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "contact/groups/indentation.hpp"
#include "contact/results/estimates/friction_capacity.hpp"
#include "contact/results/face_problems/zone_patches.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "recovery/face/far_field.hpp"

namespace cgcontact {
namespace {

/// Cells beyond the closed groups in which there may be pressure: they close when their mean gap does.
constexpr double beyond_closed = 1.25;
/// Length of the details of a face made of triangles, in facets: it reduces waves as long as a facet to a thousandth,
/// (2 pi / 2)^-6.
constexpr double facet_details = 0.5;
/// Radians between triangles from which on they are facets of something round: rounding of files makes less.
constexpr double min_angle = 1e-4;
/// Fraction of a zone's force that decides nothing.
constexpr double max_fraction_at_end = 0.01;

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

/// Returns whether the zone transmits forces where a face ends, in groups with the end along half a cell or more:
/// bodies are no half-spaces there.
bool reaches_end(const ZonePatches& patches, const FaceZone& zone) {
  const FaceGrid& grid = patches.grid();
  std::vector<double> end(zone.groups.size(), 0.0);  // m, of the face within each group
  for (const FaceShare& share : zone.shares) {
    if (!(zone.groups[share.group].force > 0)) continue;
    for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a)
      for (const int next : grid.beside(share.patch, a))
        if (next < 0 || patches.shares()[next].empty())
          end[share.group] += share.fraction * (grid.plane_strain ? patches.h() : grid.spacing[1 - a]);
  }
  double at_end = 0, force = 0;
  for (std::size_t g = 0; g < zone.groups.size(); ++g) {
    force += zone.groups[g].force;
    if (end[g] >= patches.h() / 2) at_end += zone.groups[g].force;
  }
  return at_end > max_fraction_at_end * force;
}

/// Width of the widest facets of a body where it touches, m; 0: it is not made of triangles there.
double widest_facet(const SolvedState& state, const ContactPair& pair, const ZonePatches& patches, int body) {
  const CutCells& cells = state.bodies[body].cut_cells;
  double widest = 0;
  for (const int q : patches.points()) {
    if (!patches.is_closed(q)) continue;
    const ContactPoint point = pair.points[q];
    const Vec3& position = body == pair.primary ? point.primary_position : point.secondary_position;
    widest = std::max(widest, cells.grid.cell_size * cells.solid.geometry().facet_width(position, min_angle));
  }
  return widest;
}

/// Smooths the face: patches are finer than the facets, whose edges the body does not have; no details are shorter than
/// the widest facets.
void smooth_facets(const SolvedState& state, const ContactPair& pair, const ZonePatches& patches, FaceZone& zone) {
  const FaceGrid& grid = patches.grid();
  const double patch = grid.plane_strain ? grid.spacing[1] : std::min(grid.spacing[0], grid.spacing[1]);
  for (const int body : {pair.primary, pair.secondary}) {
    const double facet = widest_facet(state, pair, patches, body);
    if (facet <= patch) continue;
    const std::vector<double>& height = patches.height(body == pair.primary ? 0 : 1);
    std::vector<FarMean> heights;
    for (int n = 0; n < grid.num_patches(); ++n)
      if (zone.inside[n]) heights.push_back({{{n, 1.0}}, height[n], 1, 1});
    const std::vector<double> smooth = FarField(grid, facet, zone.inside, heights).with_details(facet_details);
    const double side = body == pair.primary ? -1 : 1;
    for (int n = 0; n < grid.num_patches(); ++n)
      if (zone.inside[n]) zone.distance[n] += side * patches.cosine()[n] * (smooth[n] - height[n]);
  }
}

/// Collects a zone's groups and patches for its problem.
FaceZone make_zone(const SolvedState& state, const PairGroups& face, const std::vector<int>& closed,
                   const ZonePatches& patches) {
  const ContactPair& pair = face.pair();
  const std::vector<GroupOnFace>& groups = face.groups();
  const double h = patches.h();
  const auto& shares = patches.shares();
  FaceZone zone;
  zone.grid = patches.grid();
  zone.h = h;
  zone.modulus =
      effective_modulus(state.bodies[pair.primary].spec->material, state.bodies[pair.secondary].spec->material);
  zone.distance = patches.distance();
  zone.may_press.assign(shares.size(), 0);
  PointBuckets closed_points(beyond_closed * h);
  for (std::size_t k = 0; k < patches.points().size(); ++k)
    if (patches.is_closed(patches.points()[k])) closed_points.add(patches.coordinates()[k], static_cast<int>(k));
  std::vector<int> number(groups.size(), -1);
  const auto add = [&](int g) {
    if (number[g] >= 0) return;
    number[g] = static_cast<int>(zone.groups.size());
    const GroupOnFace& group = groups[g];
    double away = group.closed() ? 0 : 1e300;
    for (const int other : closed)
      if (!group.closed()) away = std::min(away, (groups[other].centre - group.centre).norm());
    zone.groups.push_back(
        {group.area / patches.thickness(), group.force / patches.thickness(), group.gap_change, away});
  };
  for (const int g : closed) add(g);
  for (std::size_t n = 0; n < shares.size(); ++n) {
    // Forces that another zone transmits are not this one's.
    const bool mine = std::none_of(shares[n].begin(), shares[n].end(), [&](const auto& share) {
      return groups[share.first].closed() && number[share.first] < 0;
    });
    zone.inside.push_back(!shares[n].empty() && mine);
    if (!zone.inside.back()) continue;
    for (const auto& [g, fraction] : shares[n]) {
      add(g);
      zone.shares.push_back({static_cast<int>(n), number[g], fraction});
    }
    const Vec3 x = patches.flat(patches.grid().centre(static_cast<int>(n)));
    zone.may_press[n] =
        closed_points.any_near(x, [&](int k) { return (patches.coordinates()[k] - x).norm() < beyond_closed * h; });
  }
  return zone;
}

/// None: the zone has no problem of this kind.
std::optional<SolvedZone> solve_zone(const ExecSpace& exec, const SolvedState& state, int pair, const PairGroups& face,
                                     const std::vector<int>& closed, const std::vector<SymmetryPlane>& planes,
                                     const FaceOptions& options) {
  const auto patches = ZonePatches::make(state, face, closed, planes, options);
  if (!patches) return std::nullopt;
  FaceZone zone = make_zone(state, face, closed, *patches);
  if (zone.shares.empty() || reaches_end(*patches, zone)) return std::nullopt;
  smooth_facets(state, face.pair(), *patches, zone);
  SolvedZone solved{pair, face.pair().primary, patches->chart(), patches->h(), {}, {}, {}, {}, {}};
  solved.known = zone.inside;
  solved.cosine = patches->cosine();
  solved.height = patches->height(0);
  solved.pressure = solve_face_zone(exec, zone, options);
  solved.edge = edge_of_zone(solved);
  return solved;
}

}  // namespace

FacePressures solve_face_pressures(const ExecSpace& exec, const SolvedState& state) {
  FacePressures result;
  const FaceOptions& options = state.scene.recovery.face;
  std::size_t first_group = 0;
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const ContactPair& pair = state.pairs[p];
    result.left_out.push_back(0);
    if (!pair.bonded() && !shear_changes_pressure(state, pair)) {
      const PairGroups face(state, static_cast<int>(p), state.outer.group_force.data() + first_group);
      const std::vector<SymmetryPlane> planes = planes_of(state, pair);
      for (const std::vector<int>& closed : face.zones(options.reach)) {
        auto zone = solve_zone(exec, state, static_cast<int>(p), face, closed, planes, options);
        if (zone)
          result.add(std::move(*zone));
        else
          ++result.left_out.back();
      }
    }
    first_group += pair.groups.size();
  }
  return result;
}

}  // namespace cgcontact
