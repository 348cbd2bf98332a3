#include "contact/results/estimates/pressure_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "contact/results/estimates/open_force.hpp"
#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/shared_values.hpp"
#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {
namespace {

/// Widths of the Gaussian of the local mean beyond which nothing counts.
constexpr double mean_reach = 3;
/// Fraction of a width: sources in one cube of that size count as one, so that few count around a row however small the
/// cells.
constexpr double mean_grain = 1. / 4;

/// Fraction of a pair's force: less than that is the tolerance of the solver.
constexpr double solved_fraction = 1e-4;

/// Marks the rows of a pair that have closed as well as open ones within ResultOptions::spoilt_at_edge cells: where the
/// contact ends inside of both faces. Rows with nothing opposite are not open ones.
std::vector<char> rows_at_border(const std::vector<ContactRow>& rows, int pair, const ResultOptions& options) {
  const auto counts = [&](const ContactRow& row) {
    return row.pair == pair && (row.active || std::isfinite(row.distance));
  };
  struct Near {
    explicit Near(double reach) : open(reach), closed(reach) {}
    PointBuckets open, closed;
  };
  std::map<double, Near> near;  // by the rows' larger cells: few sizes, and none looks farther than its own
  for (const ContactRow& row : rows)
    if (counts(row)) near.try_emplace(row.larger_cell, options.spoilt_at_edge * row.larger_cell);
  for (auto& [cell, around] : near)
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (counts(rows[i])) (rows[i].active ? around.closed : around.open).add(rows[i].x, static_cast<int>(i));
  std::vector<char> marks(rows.size(), 0);
  parallel_for("cgcontact::pressure_estimate::border", rows.size(), 128, [&](std::size_t i) {
    const ContactRow& row = rows[i];
    if (!counts(row)) return;
    const double reach = options.spoilt_at_edge * row.larger_cell;
    const Near& around = near.at(row.larger_cell);
    marks[i] = (row.active ? around.open : around.closed).any_near(row.x, [&](int k) {
      const ContactRow& other = rows[k];
      return other.body == row.body && other.normal.dot(row.normal) > same_side && (other.x - row.x).norm() < reach;
    });
  });
  return marks;
}

/// Marks the rows of a pair with nothing opposite that are farther from each closed one than its cell: their pressure
/// is zero, however the stress around is off. The nearer ones tell whether what touches is as small as a cell.
std::vector<char> rows_away_from_contact(const std::vector<ContactRow>& rows, int pair) {
  double reach = 0;
  for (const ContactRow& row : rows)
    if (row.pair == pair && row.active) reach = std::max(reach, row.larger_cell);
  PointBuckets closed(reach);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].pair == pair && rows[i].active) closed.add(rows[i].x, static_cast<int>(i));
  std::vector<char> marks(rows.size(), 0);
  parallel_for("cgcontact::pressure_estimate::away", rows.size(), 128, [&](std::size_t i) {
    const ContactRow& row = rows[i];
    if (row.pair != pair || row.active || std::isfinite(row.distance)) return;
    marks[i] =
        !(reach > 0 && closed.any_near(row.x, [&](int k) { return (rows[k].x - row.x).norm() < rows[k].larger_cell; }));
  });
  return marks;
}

/// The mean of transmitted less recovered pressure around a point. Rows near each other, beside the width of the mean
/// there, count as one, at their centroid.
class LocalMean {
 public:
  /// Rows at a border between closed and open ones do not count.
  LocalMean(const std::vector<ContactRow>& rows, const std::vector<char>& at_border, int pair,
            const ResultOptions& options)
      : options_(options) {
    std::map<std::tuple<int, int>, Source> cells;
    for (const ContactRow& r : rows) {
      if (r.pair != pair || at_border[&r - rows.data()] || !std::isfinite(r.pressure_transmitted)) continue;
      cells[{r.body, r.cell}].add(r.weight, r.weight * r.x, r.weight * (r.pressure_transmitted - r.pressure_sprc));
    }
    for (const ContactRow& r : rows)
      if (r.pair == pair && surroundings_.count(r.larger_cell) == 0)
        surroundings_.emplace(r.larger_cell, Surroundings(cells, options.mean_width * r.larger_cell));
  }

  /// Around a row, Pa.
  double at(const ContactRow& row) const {
    const Surroundings& around = surroundings_.at(row.larger_cell);
    const double width = options_.mean_width * row.larger_cell;
    double sum = 0, total = 0;
    around.buckets.each_near(row.x, [&](int i) {
      const Source& s = around.sources[i];
      const double weight = std::exp(-0.5 * (s.moment / s.area - row.x).squaredNorm() / (width * width));
      sum += weight * s.force;
      total += weight * s.area;
    });
    return total > 0 ? sum / total : 0;
  }

 private:
  struct Source {
    double area = 0, force = 0;
    Vec3 moment = Vec3::Zero();  ///< of the area
    void add(double more_area, const Vec3& more_moment, double more_force) {
      area += more_area;
      moment += more_moment;
      force += more_force;
    }
  };
  /// The sources for means of one width, m.
  struct Surroundings {
    Surroundings(const std::map<std::tuple<int, int>, Source>& cells, double width) : buckets(mean_reach * width) {
      std::map<std::array<double, 3>, Source> cubes;
      for (const auto& [cell, s] : cells) {
        const Vec3 cube = (s.moment / s.area / (mean_grain * width)).array().floor();
        cubes[{cube[0], cube[1], cube[2]}].add(s.area, s.moment, s.force);
      }
      for (const auto& [cube, s] : cubes) {
        buckets.add(s.moment / s.area, static_cast<int>(sources.size()));
        sources.push_back(s);
      }
    }
    std::vector<Source> sources;
    PointBuckets buckets;
  };

  const ResultOptions& options_;
  std::map<double, Surroundings> surroundings_;  ///< by the rows' larger cells: few sizes
};

/// Parts of the estimated error of a pair's force, relative: by the errors of the bodies, and by gaps left.
struct ForceError {
  double by_energy = 0, by_gaps = 0;
};

/// Returns the estimated error of a pair's force for that force; nothing where it has no approach. The error is the
/// energy product of the errors of both solutions (Gonzalez-Estrada, Nadal, Rodenas et al., Comput. Mech. 53 (2014)
/// 957), at most the sum over cells of the products of their norms, and the work of the approach's pressure, taken to
/// be like the solution's, on the gaps that are left between closed points: contact holds in the mean over cells only.
std::optional<ForceError> error_by_approach(const SolvedState& state, const Results& results, int pair, double normal) {
  const auto found = std::find_if(state.approaches.begin(), state.approaches.end(),
                                  [&](const Approach& approach) { return approach.pair == pair; });
  if (found == state.approaches.end() || !(normal > 0)) return std::nullopt;
  double sum = 0;  // J
  const double unit = state.scales.stress * std::pow(state.scales.length, 3);
  for (std::size_t b = 0; b < results.bodies.size(); ++b)
    for (std::size_t c = 0; c < results.bodies[b].error_of_cell.size(); ++c)
      sum += results.bodies[b].error_of_cell[c] * std::sqrt(std::max(found->error_of_cell[b][c], 0.0) * unit);
  double work = 0;  // J, of both faces
  for (const ContactRow& row : results.contact_rows)
    if (row.pair == pair && row.active && std::isfinite(row.gap))
      work += row.weight * std::abs(row.pressure_sprc * row.gap);
  return ForceError{sum / state.scales.length / normal, work / 2 * found->stiffness / (normal * normal)};
}

/// Errors of the rows whose pressure is that of the stress, Pa; 0 at others.
void estimate_from_stress(const SolvedState& state, int pair, double energy_error, std::vector<ContactRow>& rows,
                          const std::vector<char>& wanted, std::vector<double>& errors) {
  if (std::none_of(wanted.begin(), wanted.end(), [](char wants) { return wants != 0; })) return;
  const ResultOptions& options = state.scene.results;
  const std::vector<char> at_border = rows_at_border(rows, pair, options);
  const LocalMean mean(rows, at_border, pair, options);
  compute_together("cgcontact::pressure_estimate::mean_difference", 128, errors, [&](std::size_t i) {
    if (!wanted[i]) return errors[i];
    const ContactRow& row = rows[i];
    const double jump = std::isfinite(row.pressure_opposite) ? row.pressure_opposite - row.pressure_sprc : 0;
    const double common = std::hypot(mean.at(row), energy_error * row.pressure_sprc);
    return std::hypot(jump / 2, common, at_border[i] ? row.pressure_spr - row.pressure_sprc : 0.0);
  });
}

}  // namespace

void estimate_contact_errors(const SolvedState& state, Results& results) {
  std::vector<ContactRow>& rows = results.contact_rows;
  const std::vector<double> normal = normal_forces(state);
  const std::vector<OpenForce> open_force = open_forces(state, results.pairs);
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const int pair = static_cast<int>(p);
    PairFigures& figures = results.pairs[p];
    const Verdict::Pair& verdict = results.verdict.pairs[p];
    const bool touches = figures.active_points > 0;
    const double open = open_force[p].fraction;
    figures.force_given_by_loads = open_force[p].given_by_loads;
    const auto [energy_error, gap_error] = error_by_approach(state, results, pair, normal[p])
                                               .value_or(ForceError{std::pow(results.estimated_error_relative, 2), 0});
    if (touches && (open == 0 || verdict.closed_state() != Verdict::State::not_resolved))
      figures.force_error_estimate = open * (energy_error + gap_error);
    std::vector<double> errors(rows.size(), 0.0);
    std::vector<char> of_stress(rows.size(), 0);
    const std::vector<char> away = rows_away_from_contact(rows, pair);
    figures.pressure_on_face = touches;
    figures.zones_of_stress = state.faces.left_out.empty() ? 0 : state.faces.left_out[p];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].pair != pair) continue;
      const auto face = state.faces.at(pair, rows[i].body, rows[i].x, rows[i].normal);
      of_stress[i] = !face && !away[i];
      figures.pressure_on_face = figures.pressure_on_face && (face || !rows[i].touching);
      if (!face) continue;
      errors[i] = face->error;
      if (verdict.closed_state() == Verdict::State::not_resolved)
        errors[i] = std::hypot(errors[i], face->pressure - rows[i].pressure_spr);
    }
    if (figures.pressure_on_face) figures.force_error_of_pressure = open * energy_error;
    estimate_from_stress(state, pair, energy_error, rows, of_stress, errors);
    double error = 0, norm = 0;
    for (ContactRow& row : rows) {
      if (row.pair != pair) continue;
      row.pressure_error = errors[&row - rows.data()];
      error += row.weight * row.pressure_error * row.pressure_error;
      const double size = size_of_traction(row, state.pairs[p].bonded());
      norm += row.weight * size * size;
    }
    figures.pressure_error_estimate = norm > 0 ? std::sqrt(error / norm) : 0;
    if (!touches) continue;
    // What holds bodies that nothing else holds, and what the solver leaves, do not belong to the exact equilibrium.
    double unbalanced = 0;
    for (const int body : {state.pairs[p].primary, state.pairs[p].secondary})
      unbalanced = std::max(unbalanced, imbalance(results.balance[body]));
    const double wrong = normal[p] > 0 && figures.area > 0 && !state.pairs[p].bonded()
                             ? held_fraction(state, state.pairs[p]) + unbalanced / normal[p]
                             : 0;
    if (wrong < solved_fraction) continue;
    figures.pressure_error_estimate = std::hypot(figures.pressure_error_estimate, wrong);
    if (figures.force_error_estimate) figures.force_error_estimate = std::max(*figures.force_error_estimate, wrong);
  }
}

}  // namespace cgcontact
