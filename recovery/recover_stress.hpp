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

/// Patch kinds as written to the status field.
enum class PatchKind { interior = 0, boundary = 1, support = 2, contact = 3, contact_edge = 4 };

/// Input of one body.
struct RecoveryBody {
  const BodyMesh* mesh;
  const PatchSet* patches;
  const BoundaryData* boundary;
  CellStressView stress;          ///< integrals of sigma_h over all cells
  CoefficientView unconstrained;  ///< plain SPR of all nodes
};

/// Coefficients of every node of every body, constrained. `kinds`: PatchKind per node of each body.
RecoveryCounts recover_constrained(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                                   const RecoveryOptions& options, std::vector<CoefficientView>& coefficients,
                                   std::vector<std::vector<int>>& kinds);

}  // namespace cgcontact
