/// Settings of the recovery of the stress.
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

/// Degree (1 or 2) of the recovered polynomials by class of patch; 0 at the contact: 2 where closed and both bodies
/// thick.
struct RecoveryDegree {
  int interior = 1;  ///< full cells only, no contact face
  int boundary = 1;  ///< neither interior nor contact
  int contact = 0;   ///< patches that hold points of a contact face, closed or open
};

struct RecoveryOptions {
  bool spr_c = true;             ///< run the constrained recovery at the end
  double rank_tolerance = 0.1;   ///< constraints weaker than that, of the strongest of a patch, are redundant
  double auxiliary_depth = 0.5;  ///< of the auxiliary patch in the other body, its cells
  bool contact_edge = true;      ///< fit the square root at the edge of the contact zone
  RecoveryDegree degree = {};    ///< of the polynomials
  int quadratic_rings = 0;  ///< rings of cells around a node that polynomials of degree 2 are fitted to; 0: automatic
  int points_per_face = 0;  ///< 1, 3 or 6 constraint points; 0: by the degree
  double patch_volume = 1;  ///< cells: smaller patches are joined with a neighbour's
  bool inverse_variance = true;  ///< the bodies of a coupled patch count with the inverse variance of their misfits

  // Constants of the method.

  /// Of rank_tolerance, for degree 2: the rows of the curvature of a traction are weak ones although not redundant
  /// (docs/recovery.md).
  double quadratic_rank_part = 0.1;

  double rank_tolerance_of(int of_degree) const {
    return of_degree == 1 ? rank_tolerance : quadratic_rank_part * rank_tolerance;
  }

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
