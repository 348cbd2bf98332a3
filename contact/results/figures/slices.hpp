/// On quadtrees (Grid::slice) a slice of the bodies is solved: what of the results goes with their thickness.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Scales forces, moments, areas, volumes and energies of the slice to those of the bodies. Forces on their ends are
/// those of any slice. Does nothing without quadtrees.
void scale_to_thickness(const SolvedState& state, Results& results);

}  // namespace cgcontact
