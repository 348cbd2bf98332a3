/// Degree of the polynomial of every node and the rings of cells that it is fitted to; the integrals that follow from
/// that.
#pragma once

#include "recovery/patch/known_pressures.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// Chooses the polynomial of every node of a body. Automatic at the contact: degree 2 in patches with closed points
/// where both bodies are at least four cells thick in all directions of their grids, over as many rings as suit that
/// thickness where nothing knows the pressure; `known` may be null. Elsewhere one ring.
std::vector<PatchPolynomial> patch_polynomials(const std::vector<RecoveryBody>& bodies, std::size_t index,
                                               const KnownPressures* known, const RecoveryOptions& options);

/// Integrals over all cells near the closed contact points (as far as the auxiliary depth and two cells more), which
/// auxiliary patches may consist of, and over those that polynomials of degree 2 are fitted to.
StressIntegrals integrate_stress(const RecoveryBody& body, const std::vector<PatchPolynomial>& polynomials,
                                 const CellStress& stress, const RecoveryOptions& options);

}  // namespace cgcontact
