#include "contact/results/verdict/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/results/figures/contact_rows.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/verdict/missed_contact.hpp"
#include "contact/results/verdict/open_gaps.hpp"
#include "contact/results/verdict/pressure_jumps.hpp"
#include "contact/results/verdict/thickness_at_contact.hpp"
#include "contact/results/verdict/zone_width.hpp"

namespace cgcontact {
namespace {

using State = Verdict::State;

/// Assumed width of a zone known only to be smaller than a cell, cells.
constexpr double cells_of_missed_zone = 1;

struct Judged {
  Verdict::Pair pair;
  double force = 0;  // N, or the largest pressure on the whole zone
  const MissedOverlap* missed = nullptr;
  const PressureJump* jump = nullptr;
  const UnclearGap* unclear = nullptr;
  double held_fraction = 0;  // of its force, taken by what holds the bodies
  int thin_body = -1;        // thinner than its cells where it touches, or -1
  double thickness = 0;      // of that body, its cells
};

/// Judges whether one of the bodies is thinner than its cells where they touch.
void judge_thickness(const SolvedState& state, const ContactPair& pair, Judged& j) {
  for (const int body : {pair.primary, pair.secondary}) {
    if (state.bodies[body].spec->rigid()) continue;
    const auto [thickness, cell] = thickness_at_contact(state, pair, body);
    const double needed = cell * thickness / state.scene.results.wanted_thickness;
    if (thickness >= state.scene.results.min_thickness) continue;
    j.thin_body = body;
    j.thickness = thickness;
    j.pair.cell_size_needed = std::min(needed, j.pair.cell_size_needed.value_or(needed));
    j.pair.state = State::not_resolved;
  }
}

/// Estimates the width of a zone so narrow that no boundary point of its bodies lies in it, although its faces end
/// beside it: the share of its groups in the faces of their cells.
ZoneWidth width_between_points(const ContactPair& pair) {
  double area = 0, cells = 0, largest = 0;
  for (const ContactGroup& group : pair.groups) {
    if (!is_closed(pair, group)) continue;
    area += group.area;
    cells += std::pow(group.larger_cell, 2);
    largest = std::max(largest, group.larger_cell);
  }
  return {area / cells, largest};
}

/// Cells across a zone from which on its figures are reliable: fewer where problems on the faces give all of its
/// pressure (docs/accuracy.md, "The pressure on the face").
double min_cells_across(const SolvedState& state, int pair) {
  const ResultOptions& options = state.scene.results;
  const bool on_face = state.faces.has_zone(pair) && state.faces.left_out[pair] == 0;
  return on_face ? options.min_cells_on_face : options.min_cells_across;
}

/// Returns whether neither the force nor the largest pressure of its pair is wrong by a jump.
bool decides_nothing(const PressureJump& jump) {
  return !jump.is_spike() && jump.force_fraction < relevant_force_fraction;
}

std::vector<Judged> judge_pairs(const SolvedState& state, const Results& results,
                                const std::vector<MissedOverlap>& missed, const std::vector<UnclearGap>& unclear,
                                const std::vector<PressureJump>& jumps) {
  std::vector<ZoneWidth> widths = zone_widths(state);
  std::vector<Judged> judged;
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const PairFigures& figures = results.pairs[p];
    if (!widths[p].cells && figures.active_points > 0 && figures.area == 0 && figures.force_on_first.norm() > 0)
      widths[p] = width_between_points(state.pairs[p]);
    Judged j;
    j.pair.name = figures.name;
    j.force = pressing_force(figures);
    if (figures.bonded) {  // no zone that ends somewhere
      j.pair.state = State::resolved;
    } else if (figures.active_points > 0) {
      j.pair.cells_across = widths[p].cells;
      j.pair.state = widths[p].cells && *widths[p].cells < min_cells_across(state, static_cast<int>(p))
                         ? State::not_resolved
                         : State::resolved;
      if (j.pair.state == State::not_resolved)
        j.pair.cell_size_needed = widths[p].cell * *widths[p].cells / state.scene.results.wanted_cells_across;
      judge_thickness(state, state.pairs[p], j);
      if (j.force > 0) j.held_fraction = held_fraction(state, state.pairs[p]);
      if (j.held_fraction > state.scene.results.largest_hold) j.pair.state = State::not_resolved;
    }
    for (const UnclearGap& gap : unclear) {
      if (gap.pair != static_cast<int>(p)) continue;
      j.unclear = &gap;
      j.force = gap.force;
      j.pair.state = State::not_resolved;
      j.pair.cell_size_needed = gap.cell * refinement_to_tell(gap.gap, gap.error);
    }
    for (const PressureJump& jump : jumps) {
      if (jump.pair != static_cast<int>(p) || j.pair.state != State::resolved || decides_nothing(jump)) continue;
      j.jump = &jump;
      j.pair.state = State::not_resolved;
      j.pair.cell_size_needed = jump.cell / 2;
    }
    for (const MissedOverlap& overlap : missed) {
      if (overlap.pair != static_cast<int>(p)) continue;
      j.missed = &overlap;
      if (figures.active_points > 0) j.pair.of_closed = j.pair.state;
      j.pair.state = State::contact_missed;
      j.pair.cell_size_needed = overlap.cell * cells_of_missed_zone / state.scene.results.wanted_cells_across;
    }
    judged.push_back(j);
  }
  return judged;
}

std::string missed_text(const Judged& j) {
  const Vec3& x = j.missed->x;
  const auto [where, there] = j.pair.of_closed ? std::pair("in one of its zones ", " there") : std::pair("", "");
  return fmt::format(
      "contact \"{}\": no force is transmitted {}although the faces overlap by up to {:.2g} m at ({:.4g}, {:.4g}, "
      "{:.4g}) m: the contact zone{} is smaller than a cell ({:.3g} m), cells of {:.2g} m or less are needed",
      j.pair.name, where, j.missed->depth, x[0], x[1], x[2], there, j.missed->cell, *j.pair.cell_size_needed);
}

std::string unclear_text(const std::string& name, const UnclearGap& gap) {
  return fmt::format(
      "contact \"{}\": whether the faces touch is not resolved: no force is transmitted, but the smallest gap left, "
      "{:.2g} m at ({:.4g}, {:.4g}, {:.4g}) m, is within the estimated error of the displacements, {:.2g} m",
      name, gap.gap, gap.x[0], gap.x[1], gap.x[2], gap.error);
}

std::string jump_text(const std::string& name, const PressureJump& jump) {
  return fmt::format(
      "the recovered pressure of \"{}\" is {:.3g} Pa at ({:.4g}, {:.4g}, {:.4g}) m, where the finite element stress, "
      "plain SPR and the transmitted forces have {:.3g} to {:.3g} Pa around: it cannot be relied on there",
      name, jump.pressure, jump.x[0], jump.x[1], jump.x[2], jump.around_least, jump.around_most);
}

std::string unresolved_text(const SolvedState& state, const Judged& j) {
  if (j.unclear)
    return fmt::format("{}: cells of {:.2g} m or less are needed", unclear_text(j.pair.name, *j.unclear),
                       *j.pair.cell_size_needed);
  if (j.held_fraction > state.scene.results.largest_hold)
    return fmt::format(
        "contact \"{}\": what holds its bodies in motions that nothing else resists takes {:.2g} % of its force, which "
        "is wrong by about as much; smaller cells at the contact, or supports that hold the bodies, are needed",
        j.pair.name, 100 * j.held_fraction);
  if (j.thin_body >= 0)
    return fmt::format(
        "body \"{}\" is {:.2g} cells thick at the contact \"{}\": bending, and with it forces and pressures, is not "
        "resolved; cells of {:.2g} m or less are needed in it",
        state.scene.bodies[j.thin_body].name, j.thickness, j.pair.name, *j.pair.cell_size_needed);
  if (j.jump)
    return fmt::format("{}; cells of {:.2g} m or less are needed", jump_text(j.pair.name, *j.jump),
                       *j.pair.cell_size_needed);
  return fmt::format(
      "the contact zone of \"{}\" is {:.2g} cells across: its pressure, area and error estimates cannot be relied on; "
      "cells of {:.2g} m or less in both bodies are needed",
      j.pair.name, *j.pair.cells_across, *j.pair.cell_size_needed);
}

std::string resolved_text(const Results& results, const std::vector<Judged>& pairs, double min_force) {
  if (std::all_of(results.pairs.begin(), results.pairs.end(), [](const PairFigures& pair) { return pair.bonded; }))
    return "all contact is bonded: no zone to resolve";
  const Judged* narrowest = nullptr;
  for (const Judged& j : pairs)
    if (j.force >= min_force && j.pair.cells_across &&
        (!narrowest || *j.pair.cells_across < *narrowest->pair.cells_across))
      narrowest = &j;
  if (!narrowest) return "the contact is resolved";
  return fmt::format("the contact is resolved: {:.2g} cells across the zone of \"{}\"{}", *narrowest->pair.cells_across,
                     narrowest->pair.name, pairs.size() > 1 ? ", the narrowest" : "");
}

}  // namespace

double pressing_force(const PairFigures& figures) {
  return std::max(figures.force_on_first.norm(), figures.max_pressure * figures.area);
}

double largest_pressing_force(const std::vector<PairFigures>& pairs) {
  double largest = 0;
  for (const PairFigures& figures : pairs) largest = std::max(largest, pressing_force(figures));
  return largest;
}

std::vector<std::string> unclear_gap_warnings(const SolvedState& state, const std::vector<PairFigures>& pairs) {
  std::vector<std::string> warnings;
  for (const UnclearGap& gap : unclear_gaps(state, pairs)) warnings.push_back(unclear_text(pairs[gap.pair].name, gap));
  return warnings;
}

Verdict judge(const SolvedState& state, const Results& results) {
  Verdict verdict;
  const std::vector<MissedOverlap> missed = missed_overlaps(results.pairs);
  std::vector<double> max_pressures;
  for (const PairFigures& pair : results.pairs) max_pressures.push_back(pair.bonded ? 0 : pair.max_pressure);
  const std::vector<PressureJump> jumps = state.scene.recovery.spr_c
                                              ? pressure_jumps(results.contact_rows, max_pressures, state.scene.results)
                                              : std::vector<PressureJump>();
  const std::vector<UnclearGap> unclear = unclear_gaps(state, results.pairs);
  std::vector<Judged> pairs = judge_pairs(state, results, missed, unclear, jumps);
  for (const PressureJump& jump : jumps)
    if (decides_nothing(jump))
      verdict.notes.push_back(fmt::format("{} ({:.2g} % of its force)", jump_text(results.pairs[jump.pair].name, jump),
                                          100 * jump.force_fraction));
  const double largest = largest_pressing_force(results.pairs);
  for (Judged& j : pairs) {
    if (j.unclear && j.force < relevant_force_fraction * largest) {  // next to nothing, if they do
      j.pair.state = State::no_contact;
      j.pair.cell_size_needed.reset();
    }
    verdict.pairs.push_back(j.pair);
  }
  const auto find = [&](State wanted, double min_force) {
    return std::find_if(pairs.begin(), pairs.end(),
                        [&](const Judged& j) { return j.pair.state == wanted && j.force >= min_force; });
  };
  const auto end = pairs.end();
  if (!state.outer.converged) {
    verdict.state = State::not_converged;
    verdict.text = state.outer.diagnosis;
  } else if (const auto lost = find(State::contact_missed, 0); lost != end) {
    verdict.state = State::contact_missed;
    verdict.text = missed_text(*lost);
  } else if (const auto coarse = find(State::not_resolved, relevant_force_fraction * largest); coarse != end) {
    verdict.state = State::not_resolved;
    verdict.text = unresolved_text(state, *coarse);
  } else if (find(State::resolved, 0) != end) {
    verdict.state = State::resolved;
    verdict.text = resolved_text(results, pairs, relevant_force_fraction * largest);
  } else {
    verdict.state = State::no_contact;
    verdict.text = pairs.empty() ? "the scene has no contact pair" : "nothing touches: no contact carries a force";
  }
  return verdict;
}

void judge_errors(const SolvedState& state, Results& results) {
  Verdict& verdict = results.verdict;
  std::vector<double> error(results.pairs.size(), 0.0), pressure(error), cell(error);
  for (const ContactRow& row : results.contact_rows) {
    error[row.pair] += row.weight * row.pressure_error;
    pressure[row.pair] += row.weight * size_of_traction(row, state.pairs[row.pair].bonded());
    if (row.touching) cell[row.pair] = std::max(cell[row.pair], row.larger_cell);
  }
  const double largest = largest_pressing_force(results.pairs);
  for (std::size_t p = 0; p < results.pairs.size(); ++p) {
    Verdict::Pair& pair = verdict.pairs[p];
    if (pair.closed_state() != State::resolved || error[p] <= state.scene.results.largest_error * pressure[p]) continue;
    (pair.of_closed ? *pair.of_closed : pair.state) = State::not_resolved;
    if (!pair.of_closed) pair.cell_size_needed = cell[p] / 2;
    std::optional<double>& of_force = results.pairs[p].force_error_estimate;
    if (of_force && *of_force > 0) of_force.reset();
    if (verdict.state != State::resolved || pressing_force(results.pairs[p]) < relevant_force_fraction * largest)
      continue;
    verdict.state = State::not_resolved;
    verdict.text = fmt::format(
        "the estimated errors of the pressure of \"{}\" add up to {:.2g} of its integral: it cannot be relied on; "
        "cells of {:.2g} m or less are needed",
        pair.name, error[p] / pressure[p], *pair.cell_size_needed);
  }
}

}  // namespace cgcontact
