/// Which pieces of bodies are free to move, in words: bodies may consist of pieces that nothing joins.
#pragma once

#include <string>
#include <vector>

#include "contact/contact_pairs.hpp"

namespace cgcontact {

/// Says which body (or which of its separate pieces) is free to do what, and a support that would hold it; empty if all
/// are held.
std::string find_free_motion(const Scene& scene, const std::vector<BodyModel>& bodies,
                             const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs);

/// Number of the connected piece of every active cell (joined by common faces), from 0.
std::vector<int> find_pieces(const CutCells& cut_cells, int& count);

}  // namespace cgcontact
