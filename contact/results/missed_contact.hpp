/// After the solve: have faces met that no contact pair sees, or that no closed contact point tells of?
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Of the gap at a contact point by the deformation, m.
double gap_change(const SolvedState& state, const ContactPair& pair, const ContactPoint& point);

/// For each contact of the scene, m: how far it has to see, so that the points that lie inside the other body after the
/// deformation belong to it. Empty if there are none. Contacts with a search_distance of their own are left alone.
std::vector<double> missed_contact(const SolvedState& state);

/// The deepest overlap of a pair that transmits no force.
struct MissedOverlap {
  int pair = 0;
  double depth = 0;       ///< m, of the deformed bodies
  Vec3 x = Vec3::Zero();  ///< m
  double cell = 0;        ///< m, size of the larger cell there
};

/// One for each pair of the results without a closed point whose faces overlap all the same: contact is decided by the
/// mean gap of pieces of cells, so that a zone smaller than these may be lost. Looked for at the faces' boundary points
/// and, without any, between them (edges, corners, tips).
std::vector<MissedOverlap> missed_overlaps(const SolvedState& state, const Results& results);

}  // namespace cgcontact
