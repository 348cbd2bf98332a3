/// Check after the solve for triangles of a body that are larger than its cells at contact.
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Returns a sentence for each body with closed contact on triangles that are wider than a cell and meet at an angle in
/// what stands for a curved face: the pressure follows the edges between them.
std::vector<std::string> coarse_facet_warnings(const SolvedState& state);

}  // namespace cgcontact
