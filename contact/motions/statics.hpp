/// Which contact forces follow from equilibrium alone.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Do the loads give the force of a pair, whatever the bodies' stiffness? True if a virtual rigid motion of the bodies
/// exists under which the force along `direction` (unit, global axes) does all the work of the pair, and no support
/// and no other closed contact does any (principle of virtual work). What holds motions that no load drives carries no
/// force and does not count. False without a closed point.
bool force_follows_from_loads(const Scene& scene, const std::vector<BodyModel>& bodies,
                              const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                              int pair, const Vec3& direction);

}  // namespace cgcontact
