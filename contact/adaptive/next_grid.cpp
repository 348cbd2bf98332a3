#include "contact/adaptive/next_grid.hpp"

#include <algorithm>
#include <cmath>

#include "contact/adaptive/energy_sizes.hpp"
#include "contact/adaptive/first_grid.hpp"
#include "contact/results/verdict/open_gaps.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Halvings of a cell of at most `largest` that end with `smallest`.
int halvings(double largest, double smallest) {
  return std::max(0, static_cast<int>(std::floor(std::log2(largest / smallest) + rounding)));
}

/// The larger one; what is no number is worse than any.
double worse(double a, double b) { return std::isnan(a) || a > b ? a : b; }

/// Returns whether the faces of a pair without a force may still touch.
bool is_unclear(const Results& results, std::size_t pair) {
  return results.pairs[pair].min_gap && results.verdict.pairs[pair].state == Verdict::State::not_resolved;
}

std::optional<double> shear_error(const PairFigures& pair) {
  return pair.friction ? pair.friction->shear_error : std::nullopt;
}

/// The largest error of the energy norm that the targets allow, relative; infinite: any.
double allowed_energy_error(const Scene& scene, const std::vector<ZoneState>& zones, const Results& results,
                            const std::vector<double>& displacement) {
  const AccuracyOptions& options = scene.accuracy;
  double allowed = std::numeric_limits<double>::infinity();
  if (options.stress) allowed = *options.stress;
  for (std::size_t p = 0; p < zones.size(); ++p) {
    const PairFigures& figures = results.pairs[p];
    // The gap's error is a multiple of that square, too (open_gaps.hpp).
    if (is_unclear(results, p))
      allowed = std::min(
          allowed, results.estimated_error_relative * refinement_to_tell(*figures.min_gap, *figures.min_gap_error));
    if (!zones[p].relevant || !zones[p].resolved) continue;
    const double by_energy = std::pow(results.estimated_error_relative, 2);
    // The force's error is some multiple of the square of the energy norm's (pressure_estimate.hpp).
    const double factor = figures.force_error_estimate && by_energy > 0 ? *figures.force_error_estimate / by_energy : 0;
    if (options.force && factor > 0) allowed = std::min(allowed, std::sqrt(*options.force / factor));
    const double of_pressure = by_energy > 0 ? std::max(1.0, figures.force_error_of_pressure / by_energy) : 1;
    if (const auto target = options.pressure_of(figures.name))
      allowed = std::min(allowed, std::sqrt(options.force_fraction * *target / of_pressure));
  }
  auto error = displacement.begin();  // goes with the square of the energy norm's
  for (const NamedTarget& target : options.named)
    if (target.kind == NamedTarget::Kind::displacement && error != displacement.end()) {
      if (*error > 0) allowed = std::min(allowed, results.estimated_error_relative * std::sqrt(target.error / *error));
      ++error;
    }
  return allowed;
}

const BodyFields& body_named(const Results& results, const std::string& name) {
  return *std::find_if(results.bodies.begin(), results.bodies.end(),
                       [&](const BodyFields& body) { return body.name == name; });
}

/// Adds what targets of single bodies ask of them. fields: what the zones ask.
void add_body_targets(const AccuracyOptions& options, const Results& results,
                      const std::vector<std::unique_ptr<SizeField>>& fields, GridSizes& next) {
  for (const BodyTarget& target : options.stress_of_body) {
    const BodyFields& body = body_named(results, target.body);
    const std::size_t b = &body - results.bodies.data();
    if (target.error >= expected_energy_error(body, *fields[b])) continue;
    const double wanted = options.energy_aim * target.error;
    next.energy[b] = energy_sizes(body, wanted, next.first[b]);
    next.change = std::min(next.change, wanted / energy_error_of_body(body));
  }
}

}  // namespace

GridSizes first_sizes(const Scene& scene) {
  GridSizes sizes;
  sizes.first = first_cell_sizes(scene);
  sizes.zones.resize(sizes.first.size());
  sizes.energy.resize(sizes.first.size());
  return sizes;
}

void halve(GridSizes& sizes) {
  for (double& size : sizes.first) size /= 2;
  for (auto* of_bodies : {&sizes.zones, &sizes.energy})
    for (std::vector<SizedBall>& balls : *of_bodies)
      for (SizedBall& ball : balls) ball.size /= 2;
  sizes.change = 0.5;
}

std::unique_ptr<Scene> scene_on_grids(const Scene& given, const GridSizes& sizes, double factor, double max_cells) {
  const AccuracyOptions& options = given.accuracy;
  auto scene = std::make_unique<Scene>(given);
  for (std::size_t b = 0; b < scene->bodies.size(); ++b) {
    BodySpec& body = scene->bodies[b];
    const double finest = std::ldexp(sizes.first[b], 1 - options.max_levels);
    double smallest = sizes.first[b];
    const auto add = [&](std::vector<SizedBall> balls, double grading) {
      for (SizedBall& ball : balls) {
        ball.size = std::max(ball.size * factor, finest);
        smallest = std::min(smallest, ball.size);
      }
      if (!balls.empty()) body.sizes.push_back(std::make_shared<const SizeField>(std::move(balls), grading));
    };
    add(sizes.zones[b], options.grading);
    add(sizes.energy[b], options.energy_grading);
    body.max_cells = max_cells;
    body.cell_size = std::ldexp(smallest, halvings(sizes.first[b], smallest));  // halvings end with the smallest size
  }
  return scene;
}

Scene on_first_grids(const Scene& scene) {
  return scene.accuracy.any() ? *scene_on_grids(scene, first_sizes(scene)) : scene;
}

ErrorFigures error_figures(const Scene& scene, const std::vector<ZoneState>& zones, const Results& results,
                           const std::vector<double>& displacement) {
  const AccuracyOptions& options = scene.accuracy;
  ErrorFigures errors;
  errors.stress = results.estimated_error_relative;
  bool known = true, any = false;
  double pressure = 0, force = 0;
  std::optional<double> shear;
  errors.named.resize(options.named.size());
  for (std::size_t p = 0; p < zones.size(); ++p) {
    known &= !is_unclear(results, p);
    if (!zones[p].relevant) continue;
    any = true;
    known &= zones[p].resolved && zones[p].missed.empty() && results.pairs[p].force_error_estimate.has_value();
    if (const int own = options.named_pressure(results.pairs[p].name); own >= 0)
      errors.named[own] = results.pairs[p].pressure_error_estimate;
    else
      pressure = worse(pressure, results.pairs[p].pressure_error_estimate);
    force = worse(force, results.pairs[p].force_error_estimate.value_or(0));
    if (const auto own = shear_error(results.pairs[p])) shear = worse(shear.value_or(0), *own);
  }
  if (known && any) {
    errors.pressure = pressure;
    errors.force = force;
    errors.shear = shear;
  }
  bool bodies_met = true;
  for (const BodyTarget& target : options.stress_of_body) {
    errors.stress_of_body.push_back(energy_error_of_body(body_named(results, target.body)));
    bodies_met &= errors.stress_of_body.back() <= target.error;
  }
  bool named_met = true;
  auto error = displacement.begin();
  for (std::size_t k = 0; k < options.named.size(); ++k) {
    std::optional<double>& own = errors.named[k];
    if (options.named[k].kind == NamedTarget::Kind::displacement)
      own = error == displacement.end() ? std::nullopt : std::optional(*error++);
    else if (!known)
      own.reset();
    else
      own = own.value_or(0);  // the pair carries next to nothing
    named_met &= own && *own <= options.named[k].error;
  }
  errors.met = known && bodies_met && named_met && (!options.pressure || pressure <= *options.pressure) &&
               (!options.force || force <= *options.force) && (!options.shear || shear.value_or(0) <= *options.shear) &&
               (!options.stress || errors.stress <= *options.stress);
  errors.finite = std::isfinite(pressure) && std::isfinite(force) && std::isfinite(shear.value_or(0)) &&
                  std::isfinite(errors.stress) &&
                  std::all_of(errors.named.begin(), errors.named.end(),
                              [](const std::optional<double>& e) { return !e || std::isfinite(*e); });
  return errors;
}

GridSizes next_sizes(const SolvedState& state, const Results& results, const std::vector<ZoneState>& zones,
                     const GridSizes& present, const std::vector<double>& displacement) {
  const AccuracyOptions& options = state.scene.accuracy;
  GridSizes next;
  next.first = present.first;
  next.zones.resize(present.first.size());
  next.energy.resize(present.first.size());
  bool all_resolved = true;
  for (std::size_t p = 0; p < zones.size(); ++p) {
    ZoneState zone = zones[p];
    if (!zone.relevant) continue;
    all_resolved &= zone.resolved && zone.missed.empty();
    // Cells of the zone answer for what the pressure is off at its force, those elsewhere for the force.
    const double estimate = results.pairs[p].pressure_error_estimate,
                 by_force = results.pairs[p].force_error_of_pressure;
    const std::optional<double> target = options.pressure_of(results.pairs[p].name);
    const double ratio =
        by_force > 0 && target
            ? next_size_ratio(zone, std::sqrt(std::max(estimate * estimate - by_force * by_force, 0.0)),
                              *target * std::sqrt(1 - options.force_fraction * options.force_fraction), options)
            : next_size_ratio(zone, estimate, target, options);
    if (zone.resolved && !zone.width && ratio < 1)
      size_by_error(state, results, static_cast<int>(p), options.aim * *target, zone);
    else
      for (SizedBall& ball : zone.balls) ball.size = ratio * zone.cell;
    const double by_shear = size_by_shear(state, results, static_cast<int>(p), zones[p], zone);
    next.change = std::min({next.change, ratio, by_shear});
    if (!zone.missed.empty()) next.change = std::min(next.change, 1 / options.max_change);
    for (SizedBall& ball : zone.balls) ball.radius += options.beyond_zone * zone.width.value_or(0) / 2;
    for (const std::vector<SizedBall>* balls : {&zone.balls, &zone.missed})
      for (const int body : {state.pairs[p].primary, state.pairs[p].secondary})
        next.zones[body].insert(next.zones[body].end(), balls->begin(), balls->end());
  }
  if (!all_resolved) return next;
  const double allowed = allowed_energy_error(state.scene, zones, results, displacement);
  std::vector<std::unique_ptr<SizeField>> fields;
  for (const auto& balls : next.zones) fields.push_back(std::make_unique<SizeField>(balls, options.grading));
  if (allowed < expected_energy_error(results, fields)) {
    next.energy = energy_sizes(results, options.energy_aim * allowed, present.first);
    next.change = std::min(next.change, options.energy_aim * allowed / results.estimated_error_relative);
  } else {
    next.energy = present.energy;
  }
  add_body_targets(options, results, fields, next);
  return next;
}

}  // namespace cgcontact
