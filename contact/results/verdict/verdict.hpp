/// Verdict on a run: whether its contact is resolved, and if not, which cells would do.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// A pair that carries less of the largest force of all pairs does not decide about the run.
constexpr double relevant_force_fraction = 0.01;

/// Returns N, of a pair; of a closed zone (a shrink fit), whose resultant is zero, the largest pressure on all of it.
double pressing_force(const PairFigures& figures);
/// Returns N, of all pairs.
double largest_pressing_force(const std::vector<PairFigures>& pairs);

/// Returns a sentence for each pair without a force whose faces may still touch.
std::vector<std::string> unclear_gap_warnings(const SolvedState& state, const std::vector<PairFigures>& pairs);

/// Judges the run. Needs the pair figures with their gaps, contact rows and contact links of the last recovery.
Verdict judge(const SolvedState& state, const Results& results);

/// Marks contacts as not resolved whose estimated errors of the pressure add up over their faces to more than
/// ResultOptions::largest_error of the pressure itself. Needs the verdict and pressure_error of the rows.
void judge_errors(const SolvedState& state, Results& results);

}  // namespace cgcontact
