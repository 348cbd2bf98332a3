#include "core/output/report/output_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/base/files/text.hpp"
#include "core/drawing/extremes.hpp"
#include "core/output/pictures/output_plots.hpp"
#include "core/output/report/asked_accuracy.hpp"

namespace cgcontact {

namespace {

using Lines = std::vector<std::string>;

constexpr int screen_width = 80;
constexpr std::size_t screen_lines = 24;
/// A text longer than this many lines ends in three dots.
constexpr std::size_t max_text_lines = 3;

/// Limits of lists and texts that can be long.
struct Allowance {
  std::size_t pairs, warnings, text_lines, solves;
};

void append(Lines& lines, const Lines& more) { lines.insert(lines.end(), more.begin(), more.end()); }

/// At most `longest` lines of a text.
Lines shortened(Lines lines, std::size_t longest) {
  if (lines.size() <= longest) return lines;
  lines.resize(longest);
  lines.back() += " ...";
  return lines;
}

Lines paragraph(const std::string& label, const std::string& text, std::size_t longest = max_text_lines) {
  return shortened(wrapped(text, label, screen_width - 4), longest);
}

std::string in_unit(double value, const DisplayUnit& unit, int digits) {
  return short_number(value * unit.factor, digits) + " " + unit.name;
}

/// "0.41 %"; estimates below rounding are zero.
std::string percent_text(double fraction) { return percent_number(fraction < 1e-9 ? 0.0 : fraction) + " %"; }

Lines pair_table(const Results& results, std::size_t rows) {
  Lines lines{fmt::format("  {:<15} {:>11} {:>7} {:>12} {:>7} {:>8} {:>12}", "contact pair", "force", "error",
                          "max pressure", "error", "L2 error", "area")};
  const std::size_t shown = results.pairs.size() <= rows ? results.pairs.size() : rows - 1;
  for (std::size_t k = 0; k < shown; ++k) {
    const PairFigures& pair = results.pairs[k];
    const double force = told_force(pair);
    const bool coarse =
        k < results.verdict.pairs.size() && results.verdict.pairs[k].closed_state() == Verdict::State::not_resolved;
    const auto error = [&](const std::optional<double>& estimate) {
      return coarse ? "coarse" : pair.active_points > 0 && estimate ? percent_text(*estimate) : "-";
    };
    lines.push_back(fmt::format("  {:<15} {:>11} {:>7} {:>12} {:>7} {:>8} {:>12}", shortened_name(pair.name, 15),
                                in_unit(force, force_unit(force), 5), error(pair.force_error_estimate),
                                in_unit(pair.max_pressure, stress_unit(pair.max_pressure), 5),
                                error(pair.max_pressure_error_estimate), error(pair.pressure_error_estimate),
                                in_unit(pair.area, area_unit(pair.area), 4)));
  }
  if (shown < results.pairs.size())
    lines.push_back(fmt::format("  and {} more pairs, see the report", results.pairs.size() - shown));
  std::vector<std::string> bonded;
  for (const PairFigures& pair : results.pairs)
    if (pair.bonded) bonded.push_back(shortened_name(pair.name, 22));
  if (!bonded.empty() && bonded.size() <= rows) lines.push_back(fmt::format("  bonded: {}", fmt::join(bonded, ", ")));
  return lines;
}

/// "reached after 4 solves, 19.4 s: estimated error of the pressure 0.783 % (asked: 1 %)", and what stopped it if not.
std::string accuracy_text(const AccuracyFigures& accuracy) {
  std::string text =
      fmt::format("{} after {}: estimated error", accuracy.reached ? "reached" : "NOT REACHED", solves_text(accuracy));
  const char* separator = " of the ";
  for (const AskedError& error : asked_errors(accuracy)) {
    text += fmt::format("{}{} {} (asked: {})", separator, error.name,
                        error.estimate ? fine_percent(*error.estimate) : "not known, the zone is not resolved",
                        fine_percent(error.target));
    separator = ", of the ";
  }
  return accuracy.reached || accuracy.text.empty() ? text : text + "; " + accuracy.text;
}

/// The last solves of a run to an accuracy.
Lines solve_table(const AccuracyFigures& accuracy, std::size_t rows) {
  const bool with_shear = has_shear(accuracy);
  const std::size_t count = accuracy.solves.size(), first = count <= rows ? 0 : count - rows;
  if (first == count) return {};
  Lines lines{fmt::format("  {:<6} {:>13} {:>9} {:>12} {:>10} {:>10} {:>10}", "solve", "unknowns", "time", "cells from",
                          "pressure", "force", "stress") +
              (with_shear ? fmt::format(" {:>10}", "shear") : "")};
  const auto error = [](const std::optional<double>& e) { return e ? percent_text(*e) : "-"; };
  for (std::size_t k = first; k < count; ++k) {
    const SolveFigures& solve = accuracy.solves[k];
    lines.push_back(fmt::format("  {:<6} {:>13} {:>7.1f} s {:>12} {:>10} {:>10} {:>10}", k + 1, grouped(solve.unknowns),
                                solve.seconds, in_unit(solve.smallest_cell, length_unit(solve.smallest_cell), 3),
                                error(solve.pressure), error(solve.force),
                                solve.converged ? percent_text(solve.stress) : "-") +
                    (with_shear ? fmt::format(" {:>10}", error(solve.shear)) : ""));
  }
  return lines;
}

/// The first pair over the steps; all of them are in steps.csv.
Lines step_lines(const Results& results, std::size_t rows) {
  Lines lines;
  const std::size_t count = results.steps.size(), shown = count <= rows ? count : rows - 1;
  for (std::size_t k = 0; k < shown; ++k) {
    const StepFigures& s = results.steps[k];
    std::string text = fmt::format("  step {} of {}:", k + 1, count);
    if (!s.pairs.empty()) {
      const PairFigures& pair = s.pairs.front();
      const double force = told_force(pair);
      text += fmt::format(" {:<22} {}, at most {}", shortened_name(pair.name, 22), in_unit(force, force_unit(force), 4),
                          in_unit(pair.max_pressure, stress_unit(pair.max_pressure), 4));
    }
    lines.push_back(text + (s.converged ? "" : " NOT CONVERGED"));
  }
  if (shown < count) lines.push_back(fmt::format("  and {} more steps, see steps.csv", count - shown));
  return lines;
}

std::string stress_text(double value) { return in_unit(value, stress_unit(std::abs(value)), 4); }

/// The zone of the pair with the largest force, and what Hertz says; "" without a zone.
std::string zone_text(const Results& results) {
  const PairFigures* most = nullptr;
  for (const PairFigures& pair : results.pairs)
    if (pair.zone.extent && (!most || pair.zone.normal_force > most->zone.normal_force)) most = &pair;
  if (!most) return "";
  const ZoneFigures& zone = most->zone;
  const auto length = [](double metres) { return in_unit(metres, length_unit(metres), 4); };
  std::string text = fmt::format("{}{}, half axes {} x {}, mean pressure {}",
                                 results.pairs.size() > 1 ? shortened_name(most->name, 20) + ": " : "",
                                 name_of(zone.extent->shape), length(zone.extent->half_axes[0]),
                                 length(zone.extent->half_axes[1]), stress_text(zone.mean_pressure));
  if (zone.hertz)
    text += fmt::format(
        "; Hertz: {}, p0 {}",
        zone.hertz->a ? length(*zone.hertz->a) + " x " + length(zone.hertz->b) : "half width " + length(zone.hertz->b),
        stress_text(zone.hertz->p0));
  return text;
}

/// Describes the zone with the largest force of which planes of symmetry leave a fraction in the model; "" if none.
std::string symmetry_text(const Results& results) {
  const PairFigures* most = nullptr;
  for (const PairFigures& pair : results.pairs)
    if (pair.zone.sectors > 1 && (!most || pair.zone.normal_force > most->zone.normal_force)) most = &pair;
  if (!most) return "";
  const double whole = most->zone.sectors * most->zone.normal_force;
  return fmt::format("1/{} of {} is modelled, normal force {} in all", most->zone.sectors,
                     shortened_name(most->name, 20), in_unit(whole, force_unit(whole), 5));
}

/// Lists what friction could carry: a line for every pair that has some, and one for its axis.
Lines friction_table(const Results& results, std::size_t rows, bool with_axes) {
  Lines lines{fmt::format("  {:<15} {:>5} {:>11} {:>7} {:>12} {:>7} {:>13}", "friction", "mu", "capacity", "error",
                          "torque", "error", "use")};
  std::size_t shown = 0;
  for (const PairFigures& pair : results.pairs) {
    if (!pair.friction || ++shown > rows) continue;
    const FrictionFigures& friction = *pair.friction;
    const auto& torque = friction.torque;
    const auto error = [](const std::optional<double>& e) { return e ? percent_text(*e) : "-"; };
    const auto add = [&](const std::string& name, double newton, double newton_metres) {
      lines.push_back(fmt::format("  {:<15} {:>5} {:>11} {:>7} {:>12} {:>7} {:>13}", name,
                                  short_number(friction.coefficient, 3), in_unit(newton, force_unit(newton), 5),
                                  error(friction.error), torque ? scaled(newton_metres, "N m", 5) : "-",
                                  torque ? error(torque->error) : "-", friction.use ? use_text(*friction.use) : "-"));
    };
    add(shortened_name(pair.name, 15), friction.capacity, torque ? torque->capacity : 0);
    if (pair.zone.sectors > 1) add("  in all", friction.whole, torque ? torque->whole : 0);
    if (const std::string verdict = verdict_on(friction); !verdict.empty())
      append(lines, paragraph("    ", friction.shear_error ? fmt::format("{}; shear within {}", verdict,
                                                                         percent_text(*friction.shear_error))
                                                           : verdict));
    if (with_axes)
      append(lines, paragraph("    torque: ",
                              torque ? fmt::format("about ({}) through {}, {}", components_text(torque->axis.direction),
                                                   position_text(torque->axis.point, 3), name_of(torque->from))
                                     : "none, " + friction.why_no_torque));
  }
  if (shown > rows) lines.push_back(fmt::format("  and {} more pairs with friction, see the report", shown - rows));
  return lines;
}

std::string probes_text(const Results& results) {
  std::size_t points = 0, outside = 0;
  for (const ProbeFigures& probe : results.probes) {
    points += probe.points;
    outside += probe.outside;
  }
  return fmt::format("{} with {} points in probes.csv{}", results.probes.size(), points,
                     outside > 0 ? fmt::format(", {} of them outside of the bodies", outside) : "");
}

/// The least yield stress over von Mises stress of all bodies that have a yield stress.
std::optional<double> safety_factor(const Results& results) {
  std::optional<double> least;
  for (const BodyExtremes& body : results.extremes)
    if (const auto& factor = body.body.safety_factor; factor && (!least || *factor < *least)) least = factor;
  return least;
}

/// "ball moves by (0, 0, -6.4) um, turns by (0, 0, 0) mrad" of the first rigid body; "" without one.
std::string rigid_text(const Results& results) {
  std::string text;
  int more = 0;
  for (const BodyFields& body : results.bodies) {
    if (!body.rigid || !text.empty()) {
      more += body.rigid.has_value();
      continue;
    }
    const auto mrad = [&](int i) { return short_number(1e3 * body.rigid->rotation[i], 3); };
    text = fmt::format("{} moves by {}", shortened_name(body.name, 20), position_text(body.rigid->displacement, 3));
    if (!body.rigid->rotation.isZero(0)) text += fmt::format(", turns by ({}, {}, {}) mrad", mrad(0), mrad(1), mrad(2));
  }
  if (more > 0) text += fmt::format("; {} more in the report", more);
  return text;
}

std::string maxima_text(const Results& results) {
  const auto& bodies = results.extremes;
  const int stressed = body_with_largest(bodies, &Extremes::von_mises);
  const int pulled = body_with_largest(bodies, &Extremes::tension);
  const int pressed = body_with_smallest(bodies, &Extremes::compression);
  const double moved = bodies[body_with_largest(bodies, &Extremes::displacement)].body.displacement.value;
  const Extreme& most = bodies[stressed].body.von_mises;
  const auto principal = [&](double value) {  // what is rounding beside the largest stress is zero
    return stress_text(std::abs(value) < 1e-8 * most.value ? 0 : value);
  };
  std::string text = fmt::format("von Mises {} in {} at {}; principal {} to {}; displacement {}",
                                 stress_text(most.value), shortened_name(results.bodies[stressed].name, 20),
                                 position_text(most.at, 3), principal(bodies[pressed].body.compression.value),
                                 principal(bodies[pulled].body.tension.value), in_unit(moved, length_unit(moved), 4));
  if (const auto factor = safety_factor(results)) text += "; yield / von Mises " + short_number(*factor, 3);
  return text;
}

/// "3 interior, 2 contact".
std::string counts_text(const std::vector<std::pair<std::string, long long>>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text;
}

std::string recovery_text(const Results& results) {
  long long total = 0;
  for (const auto& [kind, count] : results.patches_by_kind) total += count;
  return fmt::format("{} patches ({}); {}", total, counts_text(results.patches_by_kind),
                     counts_text(results.patches_by_status));
}

std::string error_text(const Results& results) {
  std::string text =
      fmt::format("stress {} of the energy norm, displacement {}", percent_text(results.estimated_error_relative),
                  percent_text(results.displacement_error_estimate));
  if (results.has_effectivity) text += fmt::format(" (effectivity {:.3f})", results.effectivity);
  return text;
}

/// Pressure's errors against the scene's reference.
std::string reference_text(const Results& results) {
  std::string text = name_of_pressure(results);
  for (std::size_t k = 0; k < results.pressure_errors.size(); ++k)
    text += fmt::format("{} {} {}", k ? "," : "", results.pressure_errors[k].zone,
                        percent_text(results.pressure_errors[k].sprc));
  const ZoneError& whole = results.pressure_errors.front();
  return text + fmt::format("; SPR {} {}, raw {}", whole.zone, percent_text(whole.spr), percent_text(whole.raw));
}

/// Time of the phases last: that part is cut where the screen is full.
std::string cost_text(const Results& results) {
  std::string phases;
  double total = 0;
  for (const auto& [phase, seconds] : results.times_s) {
    phases += fmt::format("{}{} {:.2f}", phases.empty() ? "" : ", ", phase, seconds);
    total += seconds;
  }
  const std::string memory = scaled(static_cast<double>(results.peak_memory_bytes), "B", 3);
  return fmt::format("{:.2f} s, {} of memory{}, {} ({}): {}", total, memory, results.ranks == 1 ? "" : " per rank",
                     processors_text(results.ranks, results.threads), results.backend, phases);
}

std::string iterations_text(const Results& results) {
  long long linear = 0, points = 0;
  for (int n : results.linear_iterations) linear += n;
  for (const PairFigures& pair : results.pairs) points += pair.points;
  std::string text = fmt::format("{} outer, {} linear", results.outer_iterations, linear);
  const std::vector<long long>& cycles = results.linear_solver.cycles_of_grid;
  if (!cycles.empty()) text += fmt::format(" ({} multigrid cycles)", grouped(cycles.front()));
  if (!results.outer_residuals.empty()) text += fmt::format("; residual {:.1e}", results.outer_residuals.back());
  if (points > 0)
    text += fmt::format("; {} of {} contact points closed", grouped(results.active_points), grouped(points));
  return text;
}

Lines warning_lines(const Results& results, const Allowance& allowance) {
  Lines lines;
  const std::size_t shown = std::min(results.warnings.size(), allowance.warnings);
  for (std::size_t k = 0; k < shown; ++k)
    append(lines, paragraph("  warning:    ", results.warnings[k], allowance.text_lines));
  if (shown < results.warnings.size())
    lines.push_back(fmt::format("  and {} more warning{}, see the report", results.warnings.size() - shown,
                                results.warnings.size() - shown == 1 ? "" : "s"));
  return lines;
}

/// Names what to open next: the page if it was written, else the figures.
Lines closing_lines(const Results& results, const std::string& directory) {
  namespace fs = std::filesystem;
  Lines lines;
  std::string others;
  for (const char* name : {"report.html", "report.json", "scene.png", "steps.csv", "contact.csv", "result.vtkhdf"})
    if (fs::exists(fs::path(directory) / name)) others += fmt::format(" {}", name);
  const std::string heading = fmt::format("  results in {}:", directory);
  if (columns_of(heading + others) <= screen_width)
    lines.push_back(heading + others);
  else
    append(lines, {heading, "   " + others});
  if (!fs::exists(fs::path(directory) / "report.html")) return lines;
  const char* const next = results.converged ? "  open next: " : "  open, for what went wrong: ";
  lines.push_back(next + (fs::path(directory) / "report.html").string());
  return lines;
}

/// The verdict in words that cannot be overlooked.
std::string opening_words(const Results& results) {
  if (!results.converged) return "DID NOT CONVERGE";
  switch (results.verdict.state) {
    case Verdict::State::not_resolved:
      return "solved, but NOT RESOLVED";
    case Verdict::State::contact_missed:
      return "solved, but CONTACT MISSED";
    case Verdict::State::no_contact:
      return results.pairs.empty() ? "solved" : "solved, without contact";
    default:
      if (results.accuracy.asked && !results.accuracy.reached) return "solved, but NOT AS ACCURATE AS ASKED";
      if (results.verdict.spring_share > 0)
        return fmt::format("solved, but SPRINGS TAKE {} % OF A LOAD", percent_number(results.verdict.spring_share));
      return "solved";
  }
}

Lines summary_lines(const Results& results, const std::string& directory, const Allowance& allowance) {
  const std::string opening = opening_words(results);
  Lines lines = shortened(wrapped(results.title, opening + (results.title.empty() ? "" : ": "), screen_width - 4),
                          allowance.text_lines);
  const auto add = [&](const std::string& label, const std::string& text) {
    append(lines, paragraph(label, text, allowance.text_lines));
  };
  if (!results.diagnosis.empty()) append(lines, paragraph("  diagnosis:  ", results.diagnosis, 4));
  if (results.converged && !results.verdict.text.empty())
    append(lines, paragraph("  verdict:    ", results.verdict.text, 4));
  if (results.accuracy.asked) {
    append(lines, paragraph("  accuracy:   ", accuracy_text(results.accuracy), 4));
    append(lines, solve_table(results.accuracy, allowance.solves));
  }
  append(lines, warning_lines(results, allowance));
  add("  size:       ", fmt::format("{} unknowns, {} cells ({} cut)", grouped(results.unknowns),
                                    grouped(results.cells.active), grouped(results.cells.cut)));
  add("  iterations: ", iterations_text(results));
  if (!results.steps.empty()) append(lines, step_lines(results, allowance.pairs));
  if (!results.pairs.empty()) append(lines, pair_table(results, allowance.pairs));
  if (const std::string symmetry = symmetry_text(results); !symmetry.empty()) add("  symmetry:   ", symmetry);
  if (has_friction(results)) {
    append(lines, friction_table(results, allowance.pairs, allowance.text_lines > 1));
    append(lines, paragraph("  friction:   ", friction_note));
  }
  if (const std::string zone = zone_text(results); !zone.empty() && allowance.text_lines > 3)
    add("  zone:       ", zone);
  if (!results.extremes.empty()) add("  largest:    ", maxima_text(results));
  if (const std::string rigid = rigid_text(results); !rigid.empty()) add("  rigid:      ", rigid);
  if (!results.probes.empty()) add("  probes:     ", probes_text(results));
  add("  est. error: ", error_text(results));
  if (!results.pressure_errors.empty()) add("  true error of the pressure: ", reference_text(results));
  if (!results.patches_by_kind.empty() && allowance.text_lines > 2)
    append(lines, paragraph("  recovery:   ", recovery_text(results), 4));
  if (!results.times_s.empty()) add("  time:       ", cost_text(results));
  append(lines, closing_lines(results, directory));
  return lines;
}

}  // namespace

std::string summary(const Results& results, const std::string& directory) {
  Lines lines;
  for (const Allowance allowance : {Allowance{8, 3, 4, 6}, Allowance{6, 2, 3, 4}, Allowance{4, 1, 3, 3},
                                    Allowance{3, 1, 2, 2}, Allowance{2, 1, 1, 2}, Allowance{2, 1, 1, 0}}) {
    lines = summary_lines(results, directory, allowance);
    if (lines.size() <= screen_lines) break;
  }
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace cgcontact
