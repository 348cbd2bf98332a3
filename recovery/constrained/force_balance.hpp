/// Balance of the recovered contact pressure with the transmitted forces. The forces of the contact groups are in
/// equilibrium with the solution; where a pressure does not carry them (it ends at a corner, a knife edge or a fillet
/// of few cells, has a peak that no polynomial follows, or a patch of few closed points counts as open) only they are
/// known. Evidence: docs/recovery.md.
#pragma once

#include "recovery/constrained/patch_states.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// Adds constant stresses to the polynomials of one body's patches at the contact, so that
///
///   integral of N_a (pressure of sigma*) dA = sum of N_a (transmitted forces)
///
/// at every node a within a twentieth of the pressure around, and in the mean over about two of the larger cells there
/// within some per cent (nothing changes that is nearer than that); in total no farther than the plain recovery, or
/// within a few thousandths. Patches beside the term of a contact edge are left out: that has its size from the forces.
///
/// `field`: SPR-C of all nodes, with its terms; its polynomials are changed. `plain`: pressures of plain SPR at the
/// boundary points of the contact, Scales::stress; empty: not known. Patches that are changed get the status
/// `balanced`, if no worse one.
void balance_forces(const std::vector<RecoveryBody>& bodies, std::size_t index, const RecoveredField& field,
                    const std::vector<double>& plain, const Scales& scales, const BalanceOptions& options,
                    PatchStates& states);

/// Returns the pressure (Scales::stress, positive in compression) at the boundary points of a body that see another
/// one; 0 at the others.
std::vector<double> contact_pressures(const RecoveryBody& body, const RecoveredField& field);

}  // namespace cgcontact
