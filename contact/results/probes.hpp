/// Displacement and recovered stress at the places that the scene asks for.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Appends the figures of all probes of the scene; needs the contact rows. Points that no body holds are counted and
/// warned of.
void fill_probes(const SolvedState& state, Results& results);

}  // namespace cgcontact
