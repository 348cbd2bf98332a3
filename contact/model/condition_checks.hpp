/// Supports and contact that contradict each other on the same points of a body.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Throws InputError if two supports prescribe different displacements in one direction at one point, or if a support
/// holds the normal of a named contact face.
void check_conditions(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs);

}  // namespace cgcontact
