/// From the solved state to the Results that the output writes. SI units, global axes.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Fills cells, iterations, patches; needs no other results.
void fill_counts(const SolvedState& state, Results& results);
/// Fills the number of ranks and the work of each so far. Collective.
void fill_rank_figures(Results& results);
/// Returns the forces and moments of all supports of the scene.
std::vector<SupportFigures> support_figures(const SolvedState& state);
/// Returns the resultants on every body.
std::vector<BodyBalance> balance_of_bodies(const SolvedState& state, const std::vector<SupportFigures>& supports,
                                           const std::vector<PairFigures>& pairs);
/// Returns the displacement and stress fields of all bodies, which refer to the state; without estimated errors.
std::vector<BodyFields> body_fields(const SolvedState& state);
/// Fills error and energy of the cells of Results::bodies, which must be there, their patches, and the figures of the
/// energy norm: error estimate, effectivity.
void estimate_energy_errors(const SolvedState& state, Results& results);
/// Fills relative L2 errors of the pressure per zone (norm of the reference over the whole face) and stress errors.
void fill_pressure_errors(const SolvedState& state, Results& results);

}  // namespace cgcontact
