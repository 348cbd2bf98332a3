/// Supports of a rigid body that no rigid motion meets.
#pragma once

#include "contact/model/model.hpp"

namespace cgcontact {

/// Throws InputError if what the supports prescribe of a rigid body would deform it.
void check_supports_of_rigid_bodies(const Scene& scene, const std::vector<BodyModel>& bodies,
                                    const std::vector<SupportPoint>& supports);

}  // namespace cgcontact
