/// Data that the patches of one body are made from, by reference.
#pragma once

#include "kernels/operator/system.hpp"
#include "recovery/constrained/contact_cells.hpp"
#include "recovery/constrained/divergence.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

struct PatchContext {
  const HostExec exec;
  const std::vector<RecoveryBody>& bodies;
  const std::vector<StressIntegrals>& integrals;  ///< by body
  const int index;                                ///< of the body
  const Scales& scales;
  const RecoveryOptions& options;
  const KnownPressures* const known;  ///< null: all contact is coupled with the other body
  const RecoveryBody& body = bodies[index];
  const Grid& grid = body.mesh->cut_cells->grid;
  const ContactCells contact = {bodies, integrals, index, options.auxiliary_depth, known};

  /// Returns the active cells of the patch of a node.
  ListRange<int> cells_of(int node) const {
    const PatchSet& patches = *body.patches;
    return {patches.cells.data() + patches.begin[node], patches.cells.data() + patches.begin[node + 1]};
  }
  /// Returns the required div sigma at a point of a body, per `unit` of length (both in its grid coordinates).
  Vec3 divergence(int of_body, const Vec3& position, double unit) const {
    const RecoveryBody& there = bodies[of_body];
    return divergence_at(*there.boundary, there.mesh->cut_cells->grid, scales.stress, position, unit);
  }
};

}  // namespace cgcontact
