/// Constrained recovery (SPR-C) of all patches of all bodies: internal equilibrium, boundary tractions, contact.
#pragma once

#include <array>

#include "recovery/constrained/patch_states.hpp"
#include "recovery/patch/known_pressures.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

struct RecoveryCounts {
  std::array<long long, num_patch_kinds> kinds{};
  std::array<long long, num_patch_statuses> statuses{};
  long long grown = 0, truncated_rows = 0;
  long long quadratic = 0, lowered = 0;  ///< patches of degree 2; where that was asked for but not possible
};

struct ConstrainedRecovery {
  RecoveryCounts counts;
  std::vector<PatchStates> states;        ///< by body
  std::vector<EdgeTerms> edges;           ///< by body
  std::vector<QuadraticTerms> quadratic;  ///< by body
};

/// Recovers the stress on the threads of the host, where faces and expressions are evaluated. u: displacements of all
/// bodies, for the auxiliary patches. Replaces the polynomials of bodies[].field; the terms of the contact edges and
/// the quadratic terms come beside them. known: pressures that act as loads; other contact is coupled with the other
/// body (the paper's equation 12).
ConstrainedRecovery recover_constrained(const HostExec& exec, const std::vector<RecoveryBody>& bodies,
                                        const RealView& u, const Scales& scales, const RecoveryOptions& options,
                                        const KnownPressures* known = nullptr);

}  // namespace cgcontact
