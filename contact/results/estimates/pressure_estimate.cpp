#include "contact/results/estimates/pressure_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "contact/groups/indentation.hpp"
#include "contact/model/around_axis.hpp"
#include "contact/motions/statics.hpp"
#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/shared_values.hpp"
#include "recovery/face/symmetry_planes.hpp"
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

/// Returns the mean displacement of a body.
Vec3 mean_displacement(const SolvedState& state, int body) {
  const CutCells& cut_cells = state.bodies[body].cut_cells;
  const bool quadtree = cut_cells.grid.is_quadtree(), axisymmetric = cut_cells.grid.is_axisymmetric();
  struct Sum {
    Vec3 moved = Vec3::Zero();
    double volume = 0;
  };
  std::vector<Sum> sums(num_chunks(cut_cells.cells.size(), grain_of_medium));
  parallel_chunks("cgcontact::pressure_estimate::mean_displacement", cut_cells.cells.size(), grain_of_medium,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    for (int cell = static_cast<int>(begin); cell < static_cast<int>(end); ++cell) {
                      const double h = cut_cells.h(cell), radius = axisymmetric ? cut_cells.radius(cell) : 1;
                      const double volume = cut_cells.volume_fraction(cell) * h * h * (quadtree ? radius : h);
                      sums[chunk].moved += volume * displacement(state, body, cell, Vec3::Zero());
                      sums[chunk].volume += volume;
                    }
                  });
  Sum all;
  for (const Sum& sum : sums) {
    all.moved += sum.moved;
    all.volume += sum.volume;
  }
  return all.moved / all.volume;
}

/// Squared energy norms of the solution and of what pairs stand for.
class PairEnergies {
 public:
  PairEnergies(const SolvedState& state, const Results& results)
      : state_(state),
        results_(results),
        norm_(results.estimated_error_relative > 0
                  ? std::pow(results.estimated_error / results.estimated_error_relative, 2)
                  : 0) {}

  /// Returns the energy norm of the solution over that of a pair's contact; at least 1. Loads beside the contact, as
  /// rotation, heat or a heavier contact, have errors of their own, of which the force of a contact bears the product
  /// with those of its approach alone (Cauchy and Schwarz): its relative error grows by this ratio.
  double all_over(int pair) {
    const double own = state_.pairs[pair].bonded() ? 0 : own_energy(pair);
    return own > 0 ? std::max(1.0, std::sqrt(norm_ / own)) : 1;
  }

  /// Returns the work of a pair's pressure on the gaps that are left between closed points, over the squared energy
  /// norm: contact holds in the mean over cells only, and the energy does not know what it leaves.
  double work_on_gaps(int pair) const {
    double work = 0;  // J, of both faces
    for (const ContactRow& row : results_.contact_rows)
      if (row.pair == pair && row.active && std::isfinite(row.gap))
        work += row.weight * std::abs(row.pressure_sprc * row.gap);
    return norm_ > 0 ? work / 2 / norm_ : 0;
  }

 private:
  /// Squared energy norm of a pair's contact, J: the work of its tractions on displacements beside the bodies' means,
  /// or (fits by temperature) what its force does on faces of its area alone, if that is more. A half-space under a
  /// force N on an area A yields by N / (E* sqrt(A)), a disc by 0.89 of it (Johnson, Contact Mechanics, 3.3).
  double own_energy(int pair) {
    const ContactPair& p = state_.pairs[pair];
    const PairFigures& figures = results_.pairs[pair];
    double together = 0, normal = 0;  // N m, N, of both faces
    for (const ContactRow& row : results_.contact_rows) {
      if (row.pair != pair || !row.active || !std::isfinite(row.gap)) continue;
      const double force = row.weight * row.pressure_sprc;
      normal += force;
      together += force * (row.gap - row.distance + p.interference);
    }
    const BodyModel &a = state_.bodies[p.primary], &b = state_.bodies[p.secondary];
    const BodyMotion &moves = motion_of(p.primary), &other_moves = motion_of(p.secondary);
    const std::vector<SymmetryPlane> planes =
        common_planes(moves.planes, other_moves.planes, a.cut_cells.grid.cell_size);
    Vec3 approach = moves.mean - other_moves.mean;  // without what symmetry takes: across planes, away from an axis
    for (const SymmetryPlane& plane : planes) approach -= plane.normal.dot(approach) * plane.normal;
    sum_around_axis(*a.spec, approach);
    const double modulus = effective_modulus(a.spec->material, b.spec->material);
    const double whole_area = std::pow(2.0, static_cast<double>(planes.size())) * figures.area;
    const double of_faces =
        figures.area > 0 ? normal * normal / 4 * std::sqrt(whole_area) / (modulus * figures.area) : 0;
    const bool first = p.spec->first.body == p.primary;
    const Vec3& on_primary = first ? figures.force_on_first : figures.force_on_second;
    return std::max(std::abs(together / 2 - approach.dot(on_primary)), of_faces);
  }

  /// Planes of symmetry of a body, and its mean displacement, m.
  struct BodyMotion {
    std::vector<SymmetryPlane> planes;
    Vec3 mean;
  };
  /// Computes them once for all pairs of a body.
  const BodyMotion& motion_of(int body) {
    const auto [entry, added] = motions_.try_emplace(body);
    if (added) {
      const BodyModel& model = state_.bodies[body];
      entry->second = {symmetry_planes(model.cut_cells, model.boundary), mean_displacement(state_, body)};
    }
    return entry->second;
  }

  const SolvedState& state_;
  const Results& results_;
  double norm_;  ///< J
  std::map<int, BodyMotion> motions_;
};

/// Returns the fraction of a pair's force that its equilibrium leaves open: all of it, but where the loads give the
/// resultant what balances itself, as around a shaft. normal: sum of what its points press, N.
double open_fraction(const SolvedState& state, int pair, double normal, const PairFigures& figures) {
  if (state.pairs[pair].spec->preload && state.scene.steps.size() < 2) return 0;  // tightened to it
  const double force = figures.force_on_first.norm();
  if (force > 0 && !figures.force_given_by_loads) return 1;
  const double balanced = normal > 0 && !state.pairs[pair].bonded() ? 1 - force / normal : 0;
  return balanced > relevant_force_fraction ? balanced : 0;
}

/// Estimate of a pair's force, relative; none where the zone is not resolved.
std::optional<double> force_error(const SolvedState& state, const Verdict::Pair& verdict, double open_fraction,
                                  double energy_error) {
  if (open_fraction == 0) return 0;
  if (verdict.closed_state() == Verdict::State::not_resolved) return std::nullopt;
  return (verdict.cells_across ? state.scene.results.edge_factor : 1) * open_fraction * energy_error;
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
  const Statics statics(state.scene, state.bodies, state.supports, state.pairs);
  PairEnergies energies(state, results);
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const int pair = static_cast<int>(p);
    PairFigures& figures = results.pairs[p];
    const Verdict::Pair& verdict = results.verdict.pairs[p];
    const bool touches = figures.active_points > 0;
    const Vec3& force = figures.force_on_first;
    figures.force_given_by_loads = touches && force.norm() > 0 && statics.loads_give(pair, force.normalized());
    const double open = open_fraction(state, pair, normal[p], figures);
    const double all_over_own = touches && open > 0 ? energies.all_over(pair) : 1;
    const double energy_error = std::pow(results.estimated_error_relative, 2) * all_over_own;
    if (touches)
      figures.force_error_estimate =
          force_error(state, verdict, open, energy_error + std::pow(all_over_own, 2) * energies.work_on_gaps(pair));
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
