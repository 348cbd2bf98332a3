/// Motions that the scene leaves free are held (contact/motions, contact/solve/floating/tangential_drift.hpp): exact
/// contact does no work on them, so that what holds them takes no force. What it still takes is an error of the cells.
#pragma once

#include <string>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Adds up what holds a body although no support of the scene does, N.
Vec3 holding_force(const SolvedState& state, int body);

/// The same, or its moment about the body's middle over half its length where that is more, of the largest contact
/// force on the body: by so much the contact forces on it may be wrong. Zero: nothing holds it, or no contact acts on
/// it.
double held_fraction(const SolvedState& state, int body);
/// Returns the larger one of the two bodies of a pair.
double held_fraction(const SolvedState& state, const ContactPair& pair);
/// Returns the largest part, among the bodies, of what contact passes on that a holding takes: its force along the
/// resultant of the contact forces on a body, of the largest one. By so much displacements may be wrong.
double held_force_fraction(const SolvedState& state, const std::vector<BodyBalance>& balance);

/// Warns of bodies that are held along surfaces, with the force that it takes. Empty: none are.
std::string surface_hold_warning(const SolvedState& state);

/// Returns whether any pair carries more than rounding beside all that acts on the bodies.
bool contact_carries(const SolvedState& state);

/// Returns the sum of all that acts on a body, N: what the linear solver leaves.
double imbalance(const BodyBalance& balance);

/// Says which pair's force is no contact force, although the iteration converged: it pulls, or the forces on a body are
/// out of balance by more than ResultOptions::largest_imbalance of it, as where contact carries little beside
/// prescribed displacements. Empty: none.
std::string contact_fault(const SolvedState& state);

/// Says which pair acts on a face whose normal a support holds (automatic pairs; named ones are refused before): no
/// contact pressure acts there. Empty: none.
std::string held_contact(const SolvedState& state, const std::vector<ContactRow>& rows);

}  // namespace cgcontact
