/// After the solve: have faces met that no contact pair sees?
#pragma once

#include "contact/simulation.hpp"

namespace cgcontact {

/// For each contact of the scene, m: how far it has to see, so that the points that lie inside the other body after the
/// deformation belong to it. Empty if there are none. Contacts with a search_distance of their own are left alone.
std::vector<double> missed_contact(const Simulation& sim);

}  // namespace cgcontact
