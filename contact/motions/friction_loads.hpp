/// Loads that drive motions which only friction resists, as sliding on flat faces or turning in a press fit. Without
/// friction there is no equilibrium; a traction along the faces of the pairs with friction, equal and opposite on both
/// bodies, takes its place. It grows with the friction coefficient and in proportion to the relative motion, all over
/// the parts of the faces that may touch: forces and moments are those that friction would have, where it acts is not.
#pragma once

#include "contact/motions/free_motion.hpp"

namespace cgcontact {

/// Part of all loads: what is less drives no motion. They are integrated to 1e-9.
constexpr double no_load = 1e-7;

/// Relative motion along the faces of a pair at one of its points, of the primary body less the secondary one, in each
/// of the motions: (3, number of motions).
Eigen::MatrixXd sliding_at(const ContactPair& pair, const ContactPoint& point, const FreeMotions& motions,
                           const std::vector<BodyModel>& bodies);

/// Motions that no pair with friction resists, and those that one does. Without friction in the scene all are among the
/// first.
struct MotionsAndFriction {
  FreeMotions free, resisted;
};
/// Divides free motions.
MotionsAndFriction divide_by_friction(const FreeMotions& free, const std::vector<BodyModel>& bodies,
                                      const std::vector<ContactPair>& pairs);

/// Sets BodyModel::friction_loads of all bodies so that the loads of the present step do no work on the motions that
/// friction resists; empty without such motions, or where no load drives them.
void put_loads_in_place_of_friction(const FreeMotions& resisted, const std::vector<ContactPair>& pairs,
                                    std::vector<BodyModel>& bodies);

/// Work that the loads ask friction to balance on each of the motions, N (lengths of motions have no unit).
Eigen::VectorXd asked_of_friction(const FreeMotions& resisted, const std::vector<BodyModel>& bodies);

}  // namespace cgcontact
