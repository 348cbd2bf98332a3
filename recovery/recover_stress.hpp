/// Constrained recovery (SPR-C) of all patches of all bodies: internal equilibrium, boundary tractions, contact.
#pragma once

#include <map>
#include <string>

#include "kernels/system.hpp"
#include "recovery/boundary_data.hpp"
#include "recovery/spr.hpp"

namespace cgcontact {

struct RecoveryOptions {
  double rank_tolerance = 0.05;
  double auxiliary_depth = 0.5;  ///< cells of the other body
};

struct RecoveryCounts {
  std::map<std::string, long long> patches_by_kind;  ///< interior, boundary, support, contact, contact_edge
  long long grown = 0, truncated_rows = 0, inconsistent = 0, without_auxiliary = 0;
};

/// Input of one body; `field` holds the unconstrained fit of all nodes on entry, the constrained one on return.
struct RecoveryBody {
  const BodyMesh* mesh;
  const PatchSet* patches;
  const BoundaryData* boundary;
  RecoveredField field;
};

/// u: displacements of all bodies, for the auxiliary patches.
RecoveryCounts recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u, const Scales& scales,
                                   const RecoveryOptions& options);

}  // namespace cgcontact
