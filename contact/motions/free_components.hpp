/// Messages on connected components of bodies that are free to move.
#pragma once

#include <string>
#include <vector>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Names the body (or connected component) that is free, its motion, and a support that would hold it; empty if all are
/// held.
std::string find_free_motion(const Scene& scene, const std::vector<BodyModel>& bodies,
                             const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs);

}  // namespace cgcontact
