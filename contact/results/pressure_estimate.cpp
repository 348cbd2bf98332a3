#include "contact/results/pressure_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "contact/motions/statics.hpp"
#include "contact/results/contact_rows.hpp"
#include "contact/results/holding.hpp"
#include "contact/results/pair_figures.hpp"
#include "core/base/parallel.hpp"
#include "core/base/point_buckets.hpp"
#include "core/base/shared_values.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {
namespace {

/// Widths of the Gaussian of the local mean beyond which nothing counts.
constexpr double mean_reach = 3;
/// Part of a width: sources in one cube of that size count as one, so that few count around a row however small the
/// cells.
constexpr double mean_grain = 1. / 16;

/// Part of a pair's force: less than that is the tolerance of the solver.
constexpr double solved_part = 1e-4;

/// The edge's square-root term around a row.
struct EdgeAtRow {
  double inside = 1e300;  ///< distance from the edge, m
  double change = 0;      ///< of the terms when the edge moves by its expected error, Pa
};

/// The mean of transmitted less recovered pressure around a place. Rows near each other, beside the width of the mean
/// there, count as one, at their centroid.
class LocalMean {
 public:
  /// edges: of the rows, those nearer than spoilt_at_edge do not count.
  LocalMean(const std::vector<ContactRow>& rows, const std::vector<EdgeAtRow>& edges, int pair,
            const ResultOptions& options)
      : options_(options) {
    std::map<std::tuple<int, int>, Source> cells;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const ContactRow& r = rows[i];
      if (r.pair != pair || !std::isfinite(r.pressure_transmitted) ||
          edges[i].inside < options.spoilt_at_edge * r.larger_cell)
        continue;
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

/// The place of a row, grid coordinates, in the body whose stress it has: opposite a rigid one; none opposite: cell -1.
struct StressedPlace {
  int body, cell;
  Vec3 position;
};

StressedPlace stressed_place(const SolvedState& state, const ContactRow& row) {
  if (!state.bodies[row.body].spec->rigid())
    return {row.body, row.cell, state.bodies[row.body].cut_cells.grid.to_grid(row.x)};
  const ContactPair& pair = state.pairs[row.pair];
  const auto opposite = find_opposite(state.bodies, pair, row.body, row.x, row.normal);
  return opposite ? StressedPlace{pair.other(row.body), opposite->cell, opposite->position}
                  : StressedPlace{pair.other(row.body), -1, Vec3::Zero()};
}

EdgeAtRow edge_at_row(const SolvedState& state, const ContactRow& row) {
  EdgeAtRow result;
  const auto [body, cell, position] = stressed_place(state, row);
  const RecoveredField& field = state.sprc[body];
  if (!field.edge || cell < 0) return result;
  const BodyMesh& mesh = state.system.meshes[body];
  const CutCells& cc = state.bodies[body].cut_cells;
  const double h = cc.h(cell);
  const Vec3 xi = cell_coordinates(cc, cell, position);
  double N[8];
  hex_shape(xi.data(), N);
  for (int a = 0; a < 8; ++a)
    each_master(mesh, mesh.cell_nodes[cell][a] - mesh.first_node, [&, &place = position](int node, double weight) {
      const EdgeTerms::Term* term = field.edge->of_node(node);
      if (!term) return;
      const ContactEdge& edge = term->edge;
      const double s = edge.inside(place);
      result.inside = std::min(result.inside, s / edge.scale * h);
      result.change += weight * N[a] * std::abs(term->factor) *
                       std::abs(edge.root(s + edge.place_error * edge.scale) - edge.root(s)) * state.scales.stress;
    });
  return result;
}

/// Estimate of a pair's force, relative; none where the zone is not resolved.
std::optional<double> force_error(const SolvedState& state, const Statics& statics, int pair, PairFigures& figures,
                                  const Verdict::Pair& verdict, double energy_error) {
  const Vec3 force = figures.force_on_first;
  figures.force_given_by_loads = force.norm() > 0 && statics.loads_give(pair, force.normalized());
  const bool tightened = state.pairs[pair].spec->preload && state.scene.steps.size() < 2;  // it is the preload
  if (figures.force_given_by_loads || tightened || force.isZero(0)) return 0;
  if (verdict.state == Verdict::State::not_resolved) return std::nullopt;
  return (verdict.cells_across ? state.scene.results.edge_factor : 1) * energy_error;
}

/// Errors of the rows whose pressure is that of the stress, Pa; 0 at others.
void estimate_from_stress(const SolvedState& state, int pair, double energy_error, const Verdict::Pair& verdict,
                          std::vector<ContactRow>& rows, const std::vector<char>& wanted, std::vector<double>& errors) {
  if (std::none_of(wanted.begin(), wanted.end(), [](char wants) { return wants != 0; })) return;
  const ResultOptions& options = state.scene.results;
  std::vector<EdgeAtRow> edges(rows.size());
  parallel_for("cgcontact::pressure_estimate::edges", rows.size(), 128, [&](std::size_t i) {
    if (wanted[i]) edges[i] = edge_at_row(state, rows[i]);
  });
  const LocalMean mean(rows, edges, pair, options);
  const double across = verdict.cells_across.value_or(options.no_coarse_zone);
  const double coarse =
      std::clamp((options.no_coarse_zone - across) / (options.no_coarse_zone - options.coarse_zone), 0.0, 1.0);
  compute_together("cgcontact::pressure_estimate::mean_difference", 128, errors, [&](std::size_t i) {
    if (!wanted[i]) return errors[i];
    const ContactRow& row = rows[i];
    const double jump = std::isfinite(row.pressure_opposite) ? row.pressure_opposite - row.pressure_sprc : 0;
    const double common = std::hypot(mean.at(row), energy_error * row.pressure_sprc);
    return std::hypot(std::hypot(jump / 2, common, edges[i].change), coarse * (row.pressure_spr - row.pressure_sprc));
  });
}

}  // namespace

void estimate_contact_errors(const SolvedState& state, Results& results) {
  std::vector<ContactRow>& rows = results.contact_rows;
  const std::vector<double> normal = normal_forces(state);
  const Statics statics(state.scene, state.bodies, state.supports, state.pairs);
  const double energy_error = std::pow(results.estimated_error_relative, 2);
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const int pair = static_cast<int>(p);
    PairFigures& figures = results.pairs[p];
    const Verdict::Pair& verdict = results.verdict.pairs[p];
    const bool touches = figures.active_points > 0;
    if (touches) figures.force_error_estimate = force_error(state, statics, pair, figures, verdict, energy_error);
    std::vector<double> errors(rows.size(), 0.0);
    std::vector<char> of_stress(rows.size(), 0);
    figures.pressure_on_face = touches;
    figures.zones_of_stress = state.faces.left_out.empty() ? 0 : state.faces.left_out[p];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].pair != pair) continue;
      const auto face = state.faces.at(pair, rows[i].body, rows[i].x, rows[i].normal);
      of_stress[i] = !face;
      figures.pressure_on_face = figures.pressure_on_face && (face || !rows[i].touching);
      if (!face) continue;
      errors[i] = face->error;
      if (verdict.state == Verdict::State::not_resolved)
        errors[i] = std::hypot(errors[i], face->pressure - rows[i].pressure_spr);
    }
    if (figures.pressure_on_face && !(figures.force_error_estimate && *figures.force_error_estimate == 0))
      figures.force_part_of_pressure = energy_error;
    estimate_from_stress(state, pair, energy_error, verdict, rows, of_stress, errors);
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
    // What holds bodies that nothing else holds, and what the solver leaves, are no part of the exact equilibrium.
    double unbalanced = 0;
    for (const int body : {state.pairs[p].primary, state.pairs[p].secondary})
      unbalanced = std::max(unbalanced, imbalance(results.balance[body]));
    const double wrong = normal[p] > 0 && figures.area > 0 && !state.pairs[p].bonded()
                             ? held_part(state, state.pairs[p]) + unbalanced / normal[p]
                             : 0;
    if (wrong < solved_part) continue;
    figures.pressure_error_estimate = std::hypot(figures.pressure_error_estimate, wrong);
    if (figures.force_error_estimate) figures.force_error_estimate = std::max(*figures.force_error_estimate, wrong);
  }
}

}  // namespace cgcontact
