/// Constrained recovery (SPR-C) of all patches of all bodies: internal equilibrium, boundary tractions, contact.
#pragma once

#include <algorithm>
#include <array>

#include "recovery/patch/contact_edge.hpp"
#include "recovery/patch/patch_problem.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

struct RecoveryCounts {
  std::array<long long, num_patch_kinds> kinds{};
  std::array<long long, num_patch_statuses> statuses{};
  long long grown = 0, truncated_rows = 0;
  long long quadratic = 0, lowered = 0;  ///< patches of degree 2; where that was asked for but not possible
};

/// Kind and status of every node's patch of one body.
struct PatchStates {
  std::vector<PatchKind> kind;
  std::vector<PatchStatus> status;
  std::vector<std::pair<int, int>> pressed;     ///< nodes and the pairs that their patches carry pressure of; ascending
  std::vector<std::pair<int, int>> open_sides;  ///< nodes of these and the surfaces that are open there all the same

  bool is_pressed(int node, int pair) const {
    return std::binary_search(pressed.begin(), pressed.end(), std::pair(node, pair));
  }
  /// Whether a pair has any pressure on a surface in a cell (-1: on any): none where all patches around are open.
  bool presses(const BodyMesh& mesh, int cell, int pair, int surface) const {
    for (const int corner : mesh.cell_nodes[cell]) {
      const int node = corner - mesh.first_node;
      if (is_pressed(node, pair) && !std::binary_search(open_sides.begin(), open_sides.end(), std::pair(node, surface)))
        return true;
    }
    return false;
  }
};

struct ConstrainedRecovery {
  RecoveryCounts counts;
  std::vector<PatchStates> states;        ///< by body
  std::vector<EdgeTerms> edges;           ///< by body
  std::vector<QuadraticTerms> quadratic;  ///< by body
};

/// u: displacements of all bodies, for the auxiliary patches. The polynomials of bodies[].field are replaced; the terms
/// of the contact edges and the quadratic terms come beside them.
ConstrainedRecovery recover_constrained(const std::vector<RecoveryBody>& bodies, const RealView& u,
                                        const Scales& scales, const RecoveryOptions& options);

}  // namespace cgcontact
