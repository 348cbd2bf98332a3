/// Where bodies that loads alone press together touch first: all bodies rigid, contact and supports on springs.
#pragma once

#include "contact/free_motion.hpp"

namespace cgcontact {

/// Closes the contact points whose gap the rigid bodies, moved by the loads of the present step, close; opens all
/// others. Minimum of the convex energy
///   sum_contact k A min(0, gap)^2 / 2 + sum_supports k w (u . d - value)^2 / 2 - work of the loads
/// by Newton steps with exact line search; k is that of a layer some cells thick, so that about as many points close as
/// in an elastic contact. False, with the points as they were, if it has no minimum (nothing stops a body).
bool close_where_rigid_bodies_meet(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                   std::vector<ContactPair>& pairs);

}  // namespace cgcontact
