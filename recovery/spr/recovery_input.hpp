/// What the constrained recovery works on, and how.
#pragma once

#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patch_problem.hpp"
#include "recovery/spr/cell_stress.hpp"
#include "recovery/spr/spr.hpp"

namespace cgcontact {

struct RecoveryOptions {
  double rank_tolerance = 0.1;
  double auxiliary_depth = 0.5;  ///< cells of the other body
  bool contact_edge = true;      ///< fit the square root at the edge of the contact zone
  RecoveryDegree degree = {};    ///< of the polynomials
  int quadratic_rings = 0;  ///< rings of cells around a node that polynomials of degree 2 are fitted to; 0: automatic
  int points_per_face = 0;  ///< 1, 3 or 6 constraint points; 0: by the degree
  bool inverse_variance = true;  ///< the bodies of a coupled patch count with the inverse variance of their misfits

  /// Degree 2: a tenth, the rows of the curvature of a traction are weak ones although not redundant
  /// (docs/recovery.md).
  double rank_tolerance_of(int of_degree) const { return of_degree == 1 ? rank_tolerance : 0.1 * rank_tolerance; }
};

/// Input of one body; `field` holds the unconstrained fit of all nodes on entry, the constrained one on return.
struct RecoveryBody {
  const BodyMesh* mesh;
  const PatchSet* patches;
  const BoundaryData* boundary;
  RecoveredField field;
  CellStress stress = {};  ///< what is fitted beside `field`; empty: sigma_h of the displacements
};

}  // namespace cgcontact
