/// Check after the solve for triangles of a body that are larger than its cells at contact.
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Returns a sentence for each body with closed contact on triangles wider than a cell that stand for a curved face:
/// the pressure follows their edges.
std::vector<std::string> coarse_facet_warnings(const SolvedState& state);

}  // namespace cgcontact
