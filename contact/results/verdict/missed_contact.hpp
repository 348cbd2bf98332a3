/// Check after the solve for faces that have met although no contact pair or no closed contact point shows it.
#pragma once

#include <optional>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Returns the change of the gap at a contact point by the deformation, m.
double gap_change(const SolvedState& state, const ContactPair& pair, const ContactPoint& point);

/// Returns for each contact of the scene, m, how far it has to see to hold the points inside the other body after the
/// deformation. Empty if none. Contacts with their own search_distance stay.
std::vector<double> missed_contact(const SolvedState& state);

/// Finds the smallest gap between the deformed faces of a pair, negative where they overlap: at the faces' boundary
/// points or, unless they overlap there, between them (edges, corners, tips). Empty: nothing lies opposite.
struct LeastGap {
  double gap = 0;         ///< m
  Vec3 x = Vec3::Zero();  ///< m
  double cell = 0;        ///< m, size of the larger cell there
};
std::optional<LeastGap> min_gap(const SolvedState& state, const std::vector<ContactRow>& rows, std::size_t pair);

/// Overlap of the deformed faces in one group of a pair.
struct HiddenOverlap {
  LeastGap deepest;
  double force = 0;  ///< N, that it would transmit by the law of indentation.hpp
};

/// Finds the overlaps between the points of groups more than a cell away from all closed ones: there a zone smaller
/// than the cells may be lost.
std::vector<HiddenOverlap> hidden_overlaps(const SolvedState& state, std::size_t pair);

/// Deepest overlap of a pair where it transmits no force.
struct MissedOverlap {
  int pair = 0;
  double depth = 0;       ///< m, of the deformed bodies
  Vec3 x = Vec3::Zero();  ///< m
  double cell = 0;        ///< m, size of the larger cell there
};

/// Returns one for each pair whose faces overlap although nothing is closed, or apart from what is: the mean gap of
/// groups decides contact, so that a smaller zone may be lost. Needs the smallest gaps (open_gaps.hpp).
std::vector<MissedOverlap> missed_overlaps(const std::vector<PairFigures>& pairs);

}  // namespace cgcontact
