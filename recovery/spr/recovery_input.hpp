/// Input of the constrained recovery.
#pragma once

#include "core/settings/recovery_options.hpp"
#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patch_kinds.hpp"
#include "recovery/patch/patches.hpp"
#include "recovery/spr/cell_stress.hpp"
#include "recovery/spr/spr.hpp"

namespace cgcontact {

/// Execution space of the loops of the constrained recovery.
using HostExec = Kokkos::DefaultHostExecutionSpace;

/// Input of one body; `field` holds the unconstrained fit of the nodes that it stores on entry, the constrained one on
/// return.
struct RecoveryBody {
  const BodyMesh* mesh;
  const PatchSet* patches;
  const BoundaryData* boundary;
  RecoveredField field;
  CellStress stress = {};  ///< what is fitted beside `field`; empty: sigma_h of the displacements
};

}  // namespace cgcontact
