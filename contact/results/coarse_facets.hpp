/// After the solve: are the triangles of a body larger than its cells where it touches?
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

/// Of the triangles of a body that meet at an angle where a pair is closed: the widest one, m; in cells there. Zero:
/// there are none.
struct FacetWidth {
  double metres = 0, cells = 0;
};
FacetWidth widest_facet(const SolvedState& state, const ContactPair& pair, int body);

/// A sentence for each body with closed contact on triangles that are wider than a cell and meet at an angle in what
/// stands for a curved face: the pressure follows the edges between them.
std::vector<std::string> coarse_facet_warnings(const SolvedState& state);

}  // namespace cgcontact
