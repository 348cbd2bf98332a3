#include "contact/adaptive_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/checks/memory.hpp"
#include "contact/results/estimates/peak_estimate.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/verdict/small_strain.hpp"
#include "core/base/files/text.hpp"
#include "core/base/process/ranks.hpp"

namespace cgcontact {
namespace {

/// Unknowns of graded grids go with the size of their cells to about this power.
constexpr double unknowns_power = -2.5;
/// Those of narrow zones to a smaller one; grids that are found too large shrink by this one.
constexpr double coarsening_power = -1.7;
/// Least change of size, of the wanted one, that a limit must leave to be worth a solve.
constexpr double min_gain = 1.15;
/// Cells of a grid that is the last one again, over those of that; cells are then made so much finer.
constexpr double unchanged_cell = 0.95, finer = 0.75;
/// Times as many unknowns, at least, of a grid with the same smallest cells that is worth a solve.
constexpr double worth_a_solve = 1.2;
/// Unknowns of the first grid that looks for zones which are not resolved; each later one may have four times as many.
constexpr double first_exploration = 2.5e5;
/// Unknowns of each cell: a node of its own, or two that share the components in the plane.
constexpr double min_unknowns_per_cell = 3, min_in_plane_strain = 2;
/// Growth of the cells of a grid that was refused.
constexpr double refused_growth = 1.5;
/// Grids that are too large for a limit are made so much coarser beyond what the power says.
constexpr double step = 1.03;
/// Ratio of unknowns that must make the estimated errors smaller: in three dimensions less than half of the size of all
/// cells.
constexpr double worth_a_fall = 10;
/// A last solve with fields and pictures takes longer per unknown than those before it.
constexpr double dearer = 1.2;
/// Times max_time at which a solve that may be given up is: slightly short forecasts lose no solve, and what cannot be
/// interrupted ends within a fifth of max_time.
constexpr double give_up = 1.1;
/// Fraction of a run's time that one solve beside it must take to be reported.
constexpr double told_fraction = 0.01;
/// Settings of [accuracy] that end a run.
const char* const max_time = "max_time";
const char* const max_unknowns = "max_unknowns";

/// Ends a solve whose time is over while the run has the solution of an earlier one.
struct OutOfTime {};

/// Returns how many times as many closed groups there are on other grids.
double more_closed_groups(const SolvedState& state, const std::vector<BodyModel>& next) {
  double now = 0, then = 0;
  for (const ContactPair& pair : state.pairs)
    for (std::size_t g = 0; g < pair.num_surface_groups(); ++g) {
      const ContactGroup& group = pair.groups[g];
      if (!is_closed(pair, group)) continue;
      const CutCells& from = state.bodies[group.body].cut_cells;
      const CutCells& to = next[group.body].cut_cells;
      const int cell = to.locate(to.grid.to_grid(centre_of(pair, group)));
      ++now;
      then += cell < 0 ? 1 : std::pow(from.h(group.cell) / to.h(cell), from.grid.is_quadtree() ? 1 : 2);
    }
  return now > 0 ? then / now : 1;
}

double count_unknowns(const std::vector<BodyModel>& bodies) {
  double nodes = 0;
  for (const BodyModel& body : bodies)  // in plane strain those of one side, without what is zero across
    nodes += (body.spec->plane_strain ? (dofs_per_node - 1) / 2.0 / dofs_per_node : 1) * size_of(body.cut_cells).nodes;
  return dofs_per_node * nodes;
}

/// Returns an upper bound of one body's cells in a grid with that number of unknowns.
double max_cells(const Scene& scene, double unknowns) {
  const bool plane = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [](const BodySpec& body) { return body.plane_strain.has_value(); });
  return unknowns / (plane ? min_in_plane_strain : min_unknowns_per_cell);
}

/// The largest of the estimated errors over their targets; none: the zones are not resolved.
std::optional<double> missing_factor(const AccuracyOptions& options, const SolveFigures& solve) {
  const bool known = std::all_of(solve.named.begin(), solve.named.end(), [](const auto& error) { return error; });
  if (!solve.converged || !known || ((options.pressure || options.force || options.shear) && !solve.pressure))
    return std::nullopt;
  double largest = 0;
  if (options.pressure) largest = std::max(largest, *solve.pressure / *options.pressure);
  if (options.force) largest = std::max(largest, solve.force.value_or(0) / *options.force);
  if (options.shear) largest = std::max(largest, solve.shear.value_or(0) / *options.shear);
  if (options.stress) largest = std::max(largest, solve.stress / *options.stress);
  for (std::size_t k = 0; k < solve.stress_of_body.size(); ++k)
    largest = std::max(largest, solve.stress_of_body[k] / options.stress_of_body[k].error);
  for (std::size_t k = 0; k < solve.named.size(); ++k)
    largest = std::max(largest, *solve.named[k] / options.named[k].error);
  return largest;
}

/// Errors of a solve over their targets, seen from the next one: a pressure that changes by more than its estimate was
/// off by about the change. Infinite: not known, or zones that are not resolved while those of the next one are.
double factor_seen_from(const AccuracyOptions& options, const SolveFigures& solve, const SolveFigures& next) {
  const auto factor = missing_factor(options, solve);
  if (!factor || (next.pressure && !solve.pressure)) return std::numeric_limits<double>::infinity();
  return options.pressure && next.change ? std::max(*factor, *next.change / *options.pressure) : *factor;
}

/// s, of some phases of a run.
double seconds_of_phases(const Results& results, const std::vector<std::string>& names) {
  double sum = 0;
  for (const auto& [phase, seconds] : results.times_s)
    if (std::find(names.begin(), names.end(), phase) != names.end()) sum += seconds;
  return sum;
}

std::string number(double unknowns) { return grouped(static_cast<long long>(std::round(unknowns))); }

}  // namespace

void check_first_grids(const Scene& scene, const std::vector<BodyModel>& bodies) {
  const double unknowns = count_unknowns(bodies), allowed = scene.accuracy.max_unknowns;
  if (scene.accuracy.any() && unknowns > allowed)
    throw InputError(fmt::format("{}: accuracy.max_unknowns = {:g}: the first grid has {} already", scene.file, allowed,
                                 number(unknowns)));
}

std::string describe(int number, const SolveFigures& solve) {
  return fmt::format(
      "solve {}: {} unknowns, {:.1f} s, {} outer iterations, cells from {:.3g} m, error of pressure {} (change {}), "
      "force {}, {}stress {}",
      number, grouped(solve.unknowns), solve.seconds, solve.outer_iterations, solve.smallest_cell,
      solve.pressure ? percent_number(*solve.pressure) + " %" : "-",
      solve.change ? percent_number(*solve.change) + " %" : "-",
      solve.force ? percent_number(*solve.force) + " %" : "-",
      solve.shear ? "shear " + percent_number(*solve.shear) + " %, " : "",
      solve.converged ? percent_number(solve.stress) + " %" : "-");
}

AdaptiveRun::AdaptiveRun(const Scene& scene) : given_(scene), sizes_(first_sizes(scene)) {
  figures_.pressure = scene.accuracy.pressure;
  figures_.force = scene.accuracy.force;
  figures_.shear = scene.accuracy.shear;
  figures_.stress = scene.accuracy.stress;
  figures_.stress_of_body = scene.accuracy.stress_of_body;
  figures_.named = scene.accuracy.named;
}

/// "", or that the errors of the last solve are no smaller than those of one with a tenth of its unknowns.
std::string AdaptiveRun::standstill() const {
  const SolveFigures& last = figures_.solves.back();
  const auto now = missing_factor(given_.accuracy, last);
  for (std::size_t k = 0; now && k + 1 < figures_.solves.size(); ++k) {
    const SolveFigures& solve = figures_.solves[k];
    const double then = factor_seen_from(given_.accuracy, solve, figures_.solves[k + 1]);
    if (*now >= then && static_cast<double>(last.unknowns) >= worth_a_fall * static_cast<double>(solve.unknowns))
      return fmt::format(
          "the estimated errors no longer fall: {:.2g} times the target in solve {} ({} unknowns), {:.2g} "
          "times in solve {} ({} unknowns)",
          then, k + 1, grouped(solve.unknowns), *now, figures_.solves.size(), grouped(last.unknowns));
  }
  return "";
}

bool AdaptiveRun::has_solution() const { return simulation_ && simulation_->results.converged; }

/// Returns what is to be said before a limit that keeps the run from a grid on which it might converge.
std::string AdaptiveRun::after_failure() const { return figures_.solves.back().converged ? "" : figures_.text + "; "; }

/// The same on all ranks: limits depend on it.
double AdaptiveRun::seconds() const {
  return of_first_rank(std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
}

/// Returns those of the next solve, if everything goes with the unknowns.
double AdaptiveRun::allowed_unknowns() const {
  const AccuracyOptions& options = given_.accuracy;
  if (figures_.solves.empty()) return options.max_unknowns;
  const SolveFigures& last = figures_.solves.back();
  const double in_time =
      (options.max_time - seconds()) / (dearer * (own_ - search_)) * static_cast<double>(last.unknowns);
  return std::min(in_time, options.max_unknowns);
}

/// Estimates the time to make cells for `unknowns`, s, by that of the last grid.
double AdaptiveRun::seconds_of_cells(double unknowns) const {
  if (figures_.solves.empty()) return 0;
  return seconds_of_phases(simulation_->results, {"cut cells"}) / static_cast<double>(simulation_->results.unknowns) *
         unknowns;
}

/// Estimates the time of a solve on the next grid, s, whose cells are there already, by the phases of the last one: the
/// system goes with the unknowns, recovery and estimates, mostly of contact, with its patches.
double AdaptiveRun::forecast() const {
  const SolveFigures& last = figures_.solves.back();
  const double unknowns = count_unknowns(next_->state.bodies) / static_cast<double>(last.unknowns);
  const double cells = seconds_of_cells(static_cast<double>(last.unknowns));
  if (!last.converged) return dearer * std::max(0.0, own_ - cells) * unknowns;
  const double system = seconds_of_phases(simulation_->results, {"operator", "solve"});
  const double rest = std::max(0.0, own_ - search_ - system - cells);
  const double groups = more_closed_groups(simulation_->state, next_->state.bodies);
  return dearer * (system * unknowns + rest * std::max(unknowns, groups));
}

/// Returns how many times too large the next grid is, at most 1 if it is not; sets which limit it is.
double AdaptiveRun::excess(double allowed) {
  const double unknowns = count_unknowns(next_->state.bodies) / std::max(allowed, 1.0);
  limit_ = allowed < given_.accuracy.max_unknowns ? max_time : max_unknowns;
  if (figures_.solves.empty()) return unknowns;
  const double time = forecast() / std::max(given_.accuracy.max_time - seconds(), 1e-3);
  if (time <= unknowns) return unknowns;
  limit_ = max_time;
  return time;
}

/// Returns whether the next grid is the last one again, with targets not met: sizes are rounded to halvings, with one
/// cell size all the same way.
bool AdaptiveRun::stands_still() const {
  const SolveFigures& last = figures_.solves.back();
  double smallest = 1e300;
  for (const BodyModel& body : next_->state.bodies)
    smallest = std::min(smallest, body.cut_cells.grid.cell_size_of(body.cut_cells.grid.num_levels - 1));
  return last.converged && smallest > unchanged_cell * last.smallest_cell &&
         count_unknowns(next_->state.bodies) < worth_a_solve * static_cast<double>(last.unknowns);
}

/// Cells of the first grid, or of the next one; beyond a limit they become larger. False: hardly smaller than those
/// before.
bool AdaptiveRun::set_up(const AdaptiveCallbacks& callbacks) {
  const double allowed = allowed_unknowns();
  refused_.clear();
  if (figures_.solves.empty()) {
    set_up_within(1e300, 1, callbacks);
    check_first_grids(given_, next_->state.bodies);
    return true;
  }
  needed_ = static_cast<double>(figures_.solves.back().unknowns) * std::pow(sizes_.change, unknowns_power);
  is_counted_ = false;
  if (!resolved_) {  // where zones are is not known for certain: the grid that finds them is not to be a large one
    const double enough = first_exploration * std::pow(4.0, static_cast<double>(figures_.solves.size() - 1));
    if (enough < allowed && set_up_within(enough, 1, callbacks)) return true;
    return set_up_within(allowed, 1, callbacks);
  }
  // Not even the cells of a grid that is too large by far, or that would take what is left of the time.
  const double left = given_.accuracy.max_time - seconds();
  const bool too_large = needed_ > 4 * allowed || dearer * seconds_of_cells(needed_) > left;
  const double factor = too_large && needed_ > allowed ? std::pow(allowed / needed_, 1 / unknowns_power) : 1;
  if (!set_up_within(allowed, factor, callbacks)) return false;
  if (!stands_still()) return true;
  if (!set_up_within(allowed, finer * factor, callbacks)) return false;
  if (!stands_still()) return true;
  refused_ =
      fmt::format("its cells would be those of the last one (accuracy.max_levels = {})", given_.accuracy.max_levels);
  return false;
}

/// Makes the next grid, its refined cells times a factor that grows until the unknowns are at most `allowed`, and falls
/// from a first guess that leaves most of them. False: the cells would hardly be smaller than before.
bool AdaptiveRun::set_up_within(double allowed, double factor, const AdaptiveCallbacks& callbacks) {
  const double worth = std::pow(1 / min_gain, unknowns_power);  // times as many unknowns
  double too_fine = 0, enough = 0;                              // factors; 0: none is known
  const auto grow = [&](double growth) {
    too_fine = factor;
    factor *= growth;
    if (enough > 0) factor = enough < min_gain * too_fine ? enough : std::sqrt(too_fine * enough);
  };
  // A grid that no limit makes coarser is worth a solve even if little is missing.
  while (factor <= 1 || factor * sizes_.change < 1 / min_gain || figures_.solves.empty()) {
    if (!figures_.solves.empty() && seconds() > given_.accuracy.max_time) {
      limit_ = max_time;
      break;
    }
    next_scene_ = scene_on_grids(given_, sizes_, factor, max_cells(given_, allowed));
    next_ = std::make_unique<Simulation>(*next_scene_);
    try {
      next_->set_up(callbacks);
    } catch (const TooManyCells&) {
      grow(refused_growth);
      continue;
    } catch (const InputError& error) {  // too large for the memory, as the first grid was not
      if (figures_.solves.empty()) throw;
      refused_ = error.what();
      grow(refused_growth);
      continue;
    }
    if (factor == 1) {
      needed_ = count_unknowns(next_->state.bodies);
      is_counted_ = true;
    }
    const double times = excess(allowed);
    if (times > 1) {
      grow(step * std::pow(1 / times, 1 / coarsening_power));
    } else if (factor <= 1 || times * worth > 1 || factor <= min_gain * too_fine) {
      const double unknowns = count_unknowns(next_->state.bodies);
      if (factor <= 1 || !resolved_ || unknowns > worth * static_cast<double>(figures_.solves.back().unknowns))
        return true;
      break;
    } else {
      enough = factor;
      factor =
          too_fine > 0 ? std::sqrt(too_fine * enough) : std::max(1.0, factor * std::pow(1 / times, 1 / unknowns_power));
    }
  }
  next_.reset();
  return false;
}

/// Tells what the targets ask for. Where no zone is resolved, the sizes that would do are no more than a first guess.
std::string AdaptiveRun::needed_text() const {
  if (is_counted_) return fmt::format(": {} unknowns would be needed", number(needed_));
  if (!resolved_) return ": no grid within it resolves the zones";
  return limit_ == max_unknowns ? fmt::format(": about {} unknowns would be needed", number(needed_)) : "";
}

/// Returns whether a solve is to be given up: time is over, and there is a solution already.
bool AdaptiveRun::is_out_of_time() const { return has_solution() && seconds() > give_up * given_.accuracy.max_time; }

/// Makes the next solve the present one. One with worse estimates that misses the targets does not replace the better
/// one.
void AdaptiveRun::keep(const SolveFigures& solve, const ErrorFigures& errors) {
  const auto now = missing_factor(given_.accuracy, solve);
  const double factor = now.value_or(std::numeric_limits<double>::infinity());
  const double before = has_solution() ? factor_seen_from(given_.accuracy, figures_.solves[number_], solve) : factor;
  if (best_.simulation) {
    if (factor <= best_.factor) best_ = {};
  } else if (has_solution() && !errors.met && factor > before) {
    best_ = {std::move(scene_), std::move(simulation_), number_, before};
  }
  simulation_ = std::move(next_);
  scene_ = std::move(next_scene_);
  number_ = figures_.solves.size();
}

/// The kept solve becomes the present one again.
void AdaptiveRun::take_best() {
  if (!best_.simulation) return;
  simulation_ = std::move(best_.simulation);
  scene_ = std::move(best_.scene);
  number_ = best_.number;
}

/// Collects those of the present solve and of the ones before it since zones are resolved: until then the stress of a
/// zone grows like 1/h.
std::vector<std::vector<CellEnergies>> AdaptiveRun::energies() const {
  std::vector<std::vector<CellEnergies>> series;
  for (const SolveEnergies& solve : energies_) {
    if (solve.number > number_) break;
    if (solve.begins) series.clear();
    series.push_back(solve.of_bodies);
  }
  return series;
}

/// Solves on the next grid and estimates its errors. It becomes the present one, unless only that has a solution.
/// Throws OutOfTime.
ErrorFigures AdaptiveRun::solve(const AdaptiveCallbacks& callbacks) {
  const double before = seconds() - seconds_of_phases(next_->results, {"cut cells"});
  EarlierSolution earlier;
  if (resolved_) earlier.state = &simulation_->state;
  for (const ZoneState& zone : zones_) earlier.cell.push_back(zone.cell);
  if (has_solution()) next_->start_preloads_from(*simulation_);
  next_->solve(callbacks, earlier.state, false);
  if (!next_->results.converged && earlier.state) {  // once more, from nothing
    next_ = std::make_unique<Simulation>(*next_scene_);
    next_->set_up(callbacks);
    next_->start_preloads_from(*simulation_);
    next_->solve(callbacks, nullptr, false);
  }
  SolvedState& state = next_->state;
  Results& results = next_->results;
  SolveFigures solve;
  ErrorFigures errors;
  if (results.converged) {
    search_ = seconds();
    zones_ = zone_states(state, results);
    search_ = seconds() - search_;
    solve.change = estimate_from_two_grids(zones_, earlier, given_.accuracy, results);
    const DisplacementState displacements{named_displacements(state), results.estimated_error_relative,
                                          held_force_fraction(state, results.balance)};
    displacement_errors_ = displacement_errors(displacements, displacements_);
    displacements_ = displacements;
    for (const double e : displacement_errors_)
      results.displacement_error_estimate = std::max(results.displacement_error_estimate, e);
    errors = error_figures(*next_scene_, zones_, results, displacement_errors_);
    energies_.push_back({figures_.solves.size(), !resolved_, cell_energies(results)});
    resolved_ = errors.pressure.has_value() || zones_.empty();
  } else {
    figures_.text = fmt::format("solve {} did not converge: {}", figures_.solves.size() + 1, results.diagnosis);
    // After a solution only a contact that coarse cells have lost is worth finer ones.
    may_converge_when_finer_ =
        has_solution() ? state.outer.lost_contact && !resolved_ : state.outer.other_cells_may_help;
    search_ = 0;
  }
  solve.unknowns = results.unknowns;
  solve.outer_iterations = results.outer_iterations;
  solve.converged = results.converged;
  solve.smallest_cell = 1e300;
  for (const BodyModel& body : state.bodies) {
    const Grid& grid = body.cut_cells.grid;
    solve.levels = std::max(solve.levels, grid.num_levels);
    solve.smallest_cell = std::min(solve.smallest_cell, grid.cell_size_of(grid.num_levels - 1));
  }
  solve.pressure = errors.pressure;
  solve.force = errors.force;
  solve.shear = errors.shear;
  solve.stress = errors.stress;
  solve.stress_of_body = errors.stress_of_body;
  solve.named = errors.named;
  if (solve.converged || !has_solution()) keep(solve, errors);
  const double now = seconds();
  solve.seconds = now - begin_;
  own_ = now - before;
  begin_ = now;
  figures_.solves.push_back(solve);
  callbacks.solved(static_cast<int>(figures_.solves.size()), solve);
  return errors;
}

/// Adds what the phases of the answer leave of `all`, s: other solves, and grids that no solve came to. `paths`: s, of
/// the phases, and not of `all`.
void AdaptiveRun::tell_other_times(double all, double paths, Results& results) const {
  double own = -paths, solved = 0;
  for (const auto& [phase, s] : results.times_s) own += s;
  for (const SolveFigures& solve : figures_.solves) solved += solve.seconds;
  const double unused = all - solved, others = solved - own;
  const auto add = [&](const char* phase, double s) {
    if (s > told_fraction * all) results.times_s.insert(results.times_s.begin(), {phase, s});
  };
  add("grids without a solve", unused);
  add("other solves", others);
}

void AdaptiveRun::run(const AdaptiveCallbacks& told) {
  AdaptiveCallbacks callbacks = told;
  callbacks.phase = [&](const std::string& name) {
    if (is_out_of_time()) throw OutOfTime();
    told.phase(fmt::format("solve {}: {}", figures_.solves.size() + 1, name));
  };
  callbacks.step = [&](const OuterStep& outer_step) {
    if (is_out_of_time()) throw OutOfTime();
    told.step(outer_step);
  };
  refine(callbacks);
  next_.reset();
  take_best();
  const double all = seconds();
  simulation_->sample_paths(told);
  Results& results = simulation_->results;
  figures_.answer = static_cast<int>(number_);
  figures_.seconds = all;
  if (results.converged && number_ + 1 < figures_.solves.size())
    figures_.text += fmt::format("; the results are those of solve {}", number_ + 1);
  tell_other_times(all, seconds() - all, results);
  if (results.converged) results.singular_points = singular_points(simulation_->state, energies());
  if (!results.singular_points.empty()) estimate_peak_errors(results);  // none at a singular position
  for (const SingularPoint& point : results.singular_points) results.warnings.push_back(describe(point));
  results.accuracy = figures_;
  results.accuracy.asked = true;
}

/// Solves on finer and finer grids until the targets are met or a limit is.
void AdaptiveRun::refine(const AdaptiveCallbacks& callbacks) try {
  const AccuracyOptions& options = given_.accuracy;
  for (;;) {
    if (!set_up(callbacks)) {
      figures_.text = after_failure() +
                      (refused_.empty() ? fmt::format("accuracy.{} stopped the refinement{}", limit_, needed_text())
                                        : "the next grid was refused: " + refused_);
      break;
    }
    const ErrorFigures errors = solve(callbacks);
    const bool converged = figures_.solves.back().converged;
    if (!converged && !may_converge_when_finer_) break;
    if (converged && !errors.finite) {
      figures_.text = "an estimated error is not a number";
      break;
    }
    if (errors.met) {
      figures_.reached = true;
      figures_.text.clear();  // of a solve before that did not converge
      break;
    }
    if (const std::string text = converged ? beyond_all_grids(simulation_->state) : ""; !text.empty()) {
      figures_.text = text;
      break;
    }
    if (const std::string text = standstill(); !text.empty()) {
      figures_.text = text;
      break;
    }
    if (static_cast<int>(figures_.solves.size()) >= options.max_solves) {
      figures_.text =
          after_failure() + fmt::format("accuracy.max_solves = {} stopped the refinement", options.max_solves);
      break;
    }
    if (converged)
      sizes_ = next_sizes(simulation_->state, simulation_->results, zones_, sizes_, displacement_errors_);
    else
      halve(sizes_);
    simulation_->state.release_assembly_data();
  }
} catch (const OutOfTime&) {
  figures_.text = fmt::format("accuracy.max_time = {:g} s stopped the refinement during solve {}",
                              given_.accuracy.max_time, figures_.solves.size() + 1);
}

}  // namespace cgcontact
