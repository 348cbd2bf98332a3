/// Supports and contact that contradict each other on the same points of a body.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Cosine with a face's normal above which a direction holds that normal: what acts along it is no contact pressure.
constexpr double holds_normal = 1e-3;
/// Fraction of a contact face on which a support may lie by the rim of a declared face.
constexpr double rim = 0.01;

/// Throws InputError if supports prescribe different displacements in one direction at one point, or if a support of
/// the scene holds the normal of a named contact face: on a curved one any direction out of the face.
void check_conditions(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs);

}  // namespace cgcontact
