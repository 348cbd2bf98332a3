#include "contact/results/verdict/missed_contact.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "contact/groups/gap_samples.hpp"
#include "contact/groups/indentation.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// Passes over the boundary between the points for ever smaller gaps, and the fraction of a gap to which the smallest
/// is known then.
constexpr int max_searches = 10;
constexpr double close_enough = 0.1;
/// Overlap that is more than rounding, cells.
constexpr double min_overlap = 1e-6;

/// As far as the two bodies can be apart, m.
double far(const SolvedState& state, int a, int b) {
  const BodyModel &first = state.bodies[a], &second = state.bodies[b];
  return box_distance(first, second) + 2 * (longest_extent(first) + longest_extent(second));
}

/// Contact as the solve saw it: of an automatic pair out of reach nothing but the bodies is left.
ContactPair pair_of(const SolvedState& state, const ContactSpec& spec) {
  for (const ContactPair& pair : state.pairs)
    if (pair.spec == &spec)
      return {pair.spec, pair.primary, pair.secondary, 0, pair.reach, 0, pair.interference, {}, {}};
  return {&spec, spec.first.body, spec.second.body, 0, {}, 0, spec.interference, {}, {}};
}

/// Largest initial distance of the points beyond the pair's reach that lie inside the other body now, m; or 0.
double missed_distance(const SolvedState& state, const ContactPair& seen) {
  const BodyModel &primary = state.bodies[seen.primary], &secondary = state.bodies[seen.secondary];
  ContactPair all = seen;
  all.reach = {far(state, seen.primary, seen.secondary), 0};
  const BodyFace face(seen.face(seen.primary), primary);
  const BoundaryPoints& boundary = primary.cut_cells.boundary;
  std::vector<double> farthest(num_chunks(boundary.size(), grain_of_medium), 0.0);
  parallel_chunks("cgcontact::missed_contact::look_farther", boundary.size(), grain_of_medium,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    for (int p = static_cast<int>(begin); p < static_cast<int>(end); ++p) {
                      if (!face.contains(p)) continue;
                      const Vec3 n = primary.normal(p);
                      const auto opposite = find_opposite(state.bodies, all, seen.primary, primary.point(p), n);
                      if (!opposite || opposite->distance <= seen.reach.ahead) continue;
                      const auto moved = [&](int body, int cell, const Vec3& position) {
                        return displacement(state, body, cell,
                                            cell_coordinates(state.bodies[body].cut_cells, cell, position))
                            .dot(n);
                      };
                      const double gap = opposite->distance - seen.interference +
                                         moved(seen.secondary, opposite->cell, opposite->position) -
                                         moved(seen.primary, boundary.cell[p], boundary.position[p]);
                      if (gap < -min_overlap * secondary.cut_cells.h(opposite->cell))
                        farthest[chunk] = std::max(farthest[chunk], opposite->distance);
                    }
                  });
  return farthest.empty() ? 0.0 : *std::max_element(farthest.begin(), farthest.end());
}

/// Change of the mean gap of a group by the deformation, m.
double gap_change(const SolvedState& state, const ContactPair& pair, const ContactGroup& group) {
  double change = 0;
  for (int q = group.first_point; q < group.last_point; ++q)
    change += pair.points.weight(q) / group.area * cgcontact::gap_change(state, pair, pair.points[q]);
  return change;
}

/// Smallest gap at the faces' boundary points.
std::optional<LeastGap> gap_at_points(const std::vector<ContactRow>& rows, int pair) {
  std::optional<LeastGap> least;
  for (const ContactRow& row : rows)
    if (row.pair == pair && std::isfinite(row.gap) && (!least || row.gap < least->gap))
      least = LeastGap{row.gap, row.x, row.larger_cell};
  return least;
}

/// Samples a group where distances before deformation may be below a limit, m; empty: none is, or all points are
/// farther than that by more than a cell.
std::vector<GapSample> samples_below(const SolvedState& state, const ContactPair& pair, const ContactGroup& group,
                                     double limit) {
  if (nearest_distance(pair, group) > limit + group.larger_cell) return {};
  return sample_gap(state.bodies, pair, group, limit);
}

/// The smallest gap of the deformed faces below `enough` that lies between their boundary points: at an edge or a tip.
std::optional<LeastGap> gap_between_points(const SolvedState& state, const ContactPair& pair, double enough) {
  std::vector<std::optional<LeastGap>> least(pair.groups.size());
  parallel_for("cgcontact::missed_contact::between_points", least.size(), 1, [&](std::size_t g) {
    const ContactGroup& group = pair.groups[g];
    const double closer = pair.interference - gap_change(state, pair, group);
    for (const GapSample& sample : samples_below(state, pair, group, enough + closer))
      if (!least[g] || sample.distance - closer < least[g]->gap)
        least[g] = LeastGap{sample.distance - closer, sample.x, group.larger_cell};
  });
  std::optional<LeastGap> all;
  for (const auto& found : least)
    if (found && (!all || found->gap < all->gap)) all = found;
  return all;
}

/// The closed groups of a pair, for the search for open ones apart from them.
class ClosedGroups {
 public:
  explicit ClosedGroups(const ContactPair& pair) : pair_(pair), near_(max_reach(pair)) {
    for (std::size_t g = 0; g < pair.num_surface_groups(); ++g)
      if (is_closed(pair, pair.groups[g])) {
        near_.add(centre_of(pair, pair.groups[g]), static_cast<int>(g));
        any_ = true;
      }
  }
  /// Returns whether a closed group is at most one cell away: a row of open groups lies between.
  bool near(const ContactGroup& group) const {
    const Vec3 centre = centre_of(pair_, group);
    return any_ && near_.any_near(centre, [&](int closed) {
      const ContactGroup& other = pair_.groups[closed];
      return (centre_of(pair_, other) - centre).norm() <= reach(std::max(group.larger_cell, other.larger_cell));
    });
  }

 private:
  /// Returns the distance of the centres of groups in second next cells, along a diagonal.
  static double reach(double cell) { return 2 * std::sqrt(2.0) * cell; }
  static double max_reach(const ContactPair& pair) {
    double cell = 0;
    for (const ContactGroup& group : pair.groups) cell = std::max(cell, group.larger_cell);
    return reach(cell);
  }

  const ContactPair& pair_;
  PointBuckets near_;
  bool any_ = false;
};

/// Returns the force of an overlap, N, in plane strain on cells of one size as of a round one; samples: with distances
/// before deformation; closer: by so much, m.
double indentation_force(const SolvedState& state, const ContactPair& pair, const std::vector<GapSample>& samples,
                         double closer) {
  double volume = 0, area = 0;
  Vec3 mean = Vec3::Zero();
  for (const GapSample& sample : samples) {
    if (!(sample.distance < closer)) continue;
    volume += (closer - sample.distance) * sample.area;
    area += sample.area;
    mean += sample.area * sample.x;
  }
  if (!(area > 0)) return 0;
  const double modulus =
      effective_modulus(state.scene.bodies[pair.primary].material, state.scene.bodies[pair.secondary].material);
  const Grid& grid = state.bodies[pair.primary].cut_cells.grid;
  if (!grid.is_quadtree()) return indentation * modulus * volume / std::sqrt(area);
  const double slice = grid.slice * grid.ring(grid.to_grid(mean / area));
  return line_indentation * modulus * volume * slice / area;
}

}  // namespace

double gap_change(const SolvedState& state, const ContactPair& pair, const ContactPoint& point) {
  return point.normal.dot(displacement(state, pair.secondary, point.secondary_cell, point.secondary_xi) -
                          displacement(state, pair.primary, point.primary_cell, point.primary_xi));
}

std::vector<double> missed_contact(const SolvedState& state) {
  std::vector<double> reach;
  bool any = false;
  for (const ContactSpec& spec : state.scene.contacts) {
    const ContactPair pair = pair_of(state, spec);
    const double missed = spec.search_distance > 0 || spec.bonded ? 0.0 : missed_distance(state, pair);
    any |= missed > 0;
    reach.push_back(std::max(1.5 * missed, pair.reach.ahead));
  }
  return any ? reach : std::vector<double>();
}

std::optional<LeastGap> min_gap(const SolvedState& state, const std::vector<ContactRow>& rows, std::size_t pair) {
  const std::optional<LeastGap> at_points = gap_at_points(rows, static_cast<int>(pair));
  if (at_points && at_points->gap < 0) return at_points;
  std::optional<LeastGap> least = at_points;
  double enough = at_points ? at_points->gap : 0.0;
  for (int k = 0; k < max_searches; ++k) {  // each time to a tenth of what the last time found
    const auto between = gap_between_points(state, state.pairs[pair], enough);
    if (!between) break;
    least = between;
    if (between->gap < 0 || enough - between->gap < close_enough * between->gap) break;
    enough = between->gap;
  }
  return least;
}

std::vector<HiddenOverlap> hidden_overlaps(const SolvedState& state, std::size_t p) {
  const ContactPair& pair = state.pairs[p];
  const ClosedGroups closed(pair);
  std::vector<HiddenOverlap> overlaps(pair.num_surface_groups());
  parallel_for("cgcontact::missed_contact::hidden_overlaps", overlaps.size(), 1, [&](std::size_t g) {
    const ContactGroup& group = pair.groups[g];
    if (closed.near(group)) return;
    const double closer = pair.interference - gap_change(state, pair, group);
    const std::vector<GapSample> samples = samples_below(state, pair, group, closer);
    LeastGap& deepest = overlaps[g].deepest;
    for (const GapSample& sample : samples)
      if (const double gap = sample.distance - closer; gap < deepest.gap) deepest = {gap, sample.x, group.larger_cell};
    if (deepest.gap < -min_overlap * group.larger_cell)
      overlaps[g].force = indentation_force(state, pair, samples, closer);
  });
  overlaps.erase(std::remove_if(overlaps.begin(), overlaps.end(), [](const auto& found) { return !(found.force > 0); }),
                 overlaps.end());
  return overlaps;
}

std::vector<MissedOverlap> missed_overlaps(const std::vector<PairFigures>& pairs) {
  std::vector<MissedOverlap> overlaps;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const PairFigures& figures = pairs[p];
    if (figures.min_gap && *figures.min_gap < -min_overlap * figures.min_gap_cell)
      overlaps.push_back({static_cast<int>(p), -*figures.min_gap, figures.min_gap_at, figures.min_gap_cell});
  }
  return overlaps;
}

}  // namespace cgcontact
