#include "contact/adaptive/zone_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/adaptive/small_zone_positions.hpp"
#include "contact/results/estimates/friction_capacity.hpp"
#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/verdict/missed_contact.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "contact/results/verdict/zone_width.hpp"

namespace cgcontact {
namespace {

/// Half the diagonal of a square over its side: the ball around a group's centre that holds its facets.
constexpr double half_square_diagonal = 0.71;

/// Largest refinement at once where the position of a zone is known.
constexpr double max_narrowing = 1000;

/// Cells across a zone below which its closed groups hardly show its position and width.
constexpr double about_a_cell = 2.5;

/// Least gap of a pair over its estimated error beyond which no smaller cells look for contact.
constexpr double certainly_open = 5;

/// Growth of the local cell size from one grid to the next.
constexpr double max_growth = 2;

SizedBall ball_of(const ContactPair& pair, const ContactGroup& group) {
  return {centre_of(pair, group), half_square_diagonal * group.larger_cell, group.larger_cell};
}

void add_closed_groups(const ContactPair& pair, const ZoneWidth& width, ZoneState& zone) {
  double smallest = 1e300;
  for (std::size_t g = 0; g < pair.num_surface_groups(); ++g)
    if (const ContactGroup& group = pair.groups[g]; is_closed(pair, group)) {
      zone.balls.push_back(ball_of(pair, group));
      smallest = std::min(smallest, group.larger_cell);
    }
  zone.cell = width.cells ? width.cell : smallest;
  if (width.cells) zone.width = *width.cells * width.cell;
}

bool is_open_for_certain(const PairFigures& pair) {
  return pair.min_gap && pair.min_gap_error && *pair.min_gap > certainly_open * *pair.min_gap_error;
}

/// Adds groups whose faces are nearer to each other than a fraction of a cell, although nothing is closed.
void add_near_groups(const SolvedState& state, const ContactPair& pair, double fraction, ZoneState& zone) {
  for (const ContactGroup& group : pair.groups) {
    double gap = 1e300;
    for (int q = group.first_point; q < group.last_point; ++q)
      gap = std::min(gap, pair.points.distance(q) - pair.interference + gap_change(state, pair, pair.points[q]));
    if (gap > fraction * group.larger_cell) continue;
    zone.balls.push_back(ball_of(pair, group));
    zone.cell = std::max(zone.cell, group.larger_cell);
  }
}

/// Finds where the faces of a pair that has missed contact overlap, but for what would carry next to nothing: a grid
/// that follows the deepest overlap alone may lose the others, and these the next time.
std::vector<LeastGap> lost_zones(const SolvedState& state, const std::vector<MissedOverlap>& missed, std::size_t pair) {
  const auto own = std::find_if(missed.begin(), missed.end(),
                                [&](const MissedOverlap& overlap) { return overlap.pair == static_cast<int>(pair); });
  if (own == missed.end()) return {};
  const std::vector<HiddenOverlap> overlaps = hidden_overlaps(state, pair);
  double force = 0;
  for (const HiddenOverlap& overlap : overlaps) force += overlap.force;
  std::vector<LeastGap> lost;
  for (const HiddenOverlap& overlap : overlaps)
    if (overlap.force >= relevant_force_fraction * force) lost.push_back(overlap.deepest);
  if (lost.empty()) lost.push_back({-own->depth, own->x, own->cell});  // at the faces' points
  return lost;
}

/// Returns the ratios of new to present cells of the closed groups of a pair (one per ball of its zone) with the
/// fewest cells for `target` as the relative error, as errors fall like the size. error, size: of a row, squared.
/// Empty: no error.
template <class ErrorOf, class SizeOf>
std::vector<double> ratios_by_error(const SolvedState& state, const Results& results, int p, double target,
                                    const ErrorOf& error_of, const SizeOf& size_of) {
  const ContactPair& pair = state.pairs[p];
  std::map<std::pair<int, int>, double> squared;  // by body and cell
  double norm = 0, all = 0;
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != p) continue;
    const double error = row.weight * error_of(row);
    squared[{row.body, row.cell}] += error;
    all += error;
    norm += row.weight * size_of(row);
  }
  std::vector<double> errors;
  double of_groups = 0;
  for (std::size_t g = 0; g < pair.num_surface_groups(); ++g)
    if (const ContactGroup& group = pair.groups[g]; is_closed(pair, group)) {
      errors.push_back(squared[{group.body, group.cell}]);
      of_groups += errors.back();
    }
  if (!(of_groups > 0)) return {};
  double sum = 0;
  for (double& e : errors) sum += e = std::sqrt(e * all / of_groups);  // as if one body had the errors of both
  for (double& e : errors) e = target * std::sqrt(norm) / std::sqrt(e * sum);
  return errors;
}

}  // namespace

std::vector<ZoneState> zone_states(const SolvedState& state, const Results& results) {
  std::vector<ZoneState> zones(state.pairs.size());
  const double largest = largest_pressing_force(results.pairs);
  const std::vector<ZoneWidth> widths = zone_widths(state);
  const std::vector<MissedOverlap> missed = missed_overlaps(results.pairs);
  for (std::size_t p = 0; p < zones.size(); ++p) {
    ZoneState& zone = zones[p];
    const ContactPair& pair = state.pairs[p];
    const Verdict::Pair& verdict = results.verdict.pairs[p];
    const std::vector<LeastGap> lost = lost_zones(state, missed, p);
    for (const LeastGap& gap : lost)
      zone.missed.push_back({gap.x, gap.cell, gap.cell / state.scene.accuracy.max_change});
    if (results.pairs[p].active_points > 0) {
      zone.relevant = pressing_force(results.pairs[p]) >= relevant_force_fraction * largest;
      zone.resolved = verdict.closed_state() == Verdict::State::resolved;
      add_closed_groups(pair, widths[p], zone);
      if (!verdict.of_closed) zone.needed = verdict.cell_size_needed;
      // The overlap of a force: one that the loads do not give is off as far as cells larger than the zone are soft. Of
      // bodies of revolution one more grid costs nothing.
      const bool knows_force =
          results.pairs[p].force_given_by_loads || !state.bodies[pair.primary].cut_cells.grid.is_axisymmetric();
      if (zone.relevant && !zone.resolved && verdict.cells_across && *verdict.cells_across < about_a_cell &&
          knows_force)
        narrow_to_overlap(state, p, zone);
      zone.relevant |= !zone.missed.empty();
      continue;
    }
    for (const LeastGap& gap : lost) zone.cell = std::max(zone.cell, gap.cell);
    if (lost.empty() && !is_open_for_certain(results.pairs[p]))
      add_near_groups(state, pair, state.scene.accuracy.near_gap, zone);
    zone.relevant = !zone.balls.empty() || !zone.missed.empty();
  }
  return zones;
}

void size_by_error(const SolvedState& state, const Results& results, int p, double target, ZoneState& zone) {
  const bool bonded = state.pairs[p].bonded();
  const auto error = [](const ContactRow& row) { return row.pressure_error * row.pressure_error; };
  const auto size = [&](const ContactRow& row) { return std::pow(size_of_traction(row, bonded), 2); };
  const std::vector<double> ratios = ratios_by_error(state, results, p, target, error, size);
  for (std::size_t g = 0; g < ratios.size(); ++g)
    zone.balls[g].size *= std::clamp(ratios[g], 1 / state.scene.accuracy.max_change, max_growth);
}

double size_by_shear(const SolvedState& state, const Results& results, int p, const ZoneState& present,
                     ZoneState& zone) {
  const AccuracyOptions& options = state.scene.accuracy;
  const auto& friction = results.pairs[p].friction;
  if (!options.shear || !zone.resolved || !friction || !friction->shear_error) return 1;
  double smallest = 1;
  const bool missed = *friction->shear_error > *options.shear;
  const auto size = [](const ContactRow& row) { return row.shear_sprc.squaredNorm(); };
  const std::vector<double> ratios =
      missed ? ratios_by_error(state, results, p, options.aim * *options.shear, squared_shear_difference, size)
             : std::vector<double>(zone.balls.size(), 1);
  for (std::size_t g = 0; g < ratios.size(); ++g) {
    const double ratio = std::clamp(ratios[g], 1 / options.max_change, 1.0);
    smallest = std::min(smallest, ratio);
    zone.balls[g].size = std::min(zone.balls[g].size, ratio * present.balls[g].size);
  }
  return smallest;
}

double next_size_ratio(const ZoneState& zone, double estimate, std::optional<double> target,
                       const AccuracyOptions& options) {
  if (!zone.relevant) return 1;
  if (!zone.resolved) {
    double ratio = 1 / options.max_change;
    if (zone.width)  // by counting cells it is known to one of them
      ratio = (*zone.width / zone.cell + (zone.narrowed ? 0 : 1)) / (2 * options.middle_cells);
    else if (zone.needed)
      ratio = std::min(ratio, *zone.needed / zone.cell);
    return std::clamp(ratio, 1 / (zone.narrowed ? max_narrowing : options.narrowing), 1 / options.min_change);
  }
  if (!target || estimate <= *target) return 1;
  return std::clamp(std::pow(options.aim * *target / zone.error, 1 / options.rate), 1 / options.max_change,
                    1 / options.min_change);
}

}  // namespace cgcontact
