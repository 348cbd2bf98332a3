/// From the solved state to the Results that the output writes. SI units, global axes.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Fills cells, iterations, patches; needs no other results.
void fill_counts(const SolvedState& state, Results& results);
/// Fills the number of ranks and the work of each so far. Collective.
void fill_rank_figures(Results& results);
/// Fills displacement and stress fields, error estimate and effectivity. They refer to the state.
void fill_body_fields(const SolvedState& state, Results& results);
/// Fills the fields alone.
void fill_fields(const SolvedState& state, Results& results);
void fill_support_figures(const SolvedState& state, Results& results);
/// Resultants on every body; needs the pair figures.
void fill_balance(const SolvedState& state, Results& results);
/// Fills relative L2 errors of the pressure per zone (norm of the reference over the whole face) and stress errors.
void fill_pressure_errors(const SolvedState& state, Results& results);

}  // namespace cgcontact
