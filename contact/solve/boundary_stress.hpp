/// Plain SPR of just the patches that touch supports and contact, for the stabilising stress of the outer loop.
#pragma once

#include <utility>

#include "contact/model/contact_pairs.hpp"
#include "recovery/spr/spr.hpp"

namespace cgcontact {

/// Returns cells of each body in which the outer loop evaluates the recovered stress, ascending; on several ranks those
/// of its own points (share_out of the points of supports and of each pair).
std::vector<std::vector<int>> stabilised_cells(const std::vector<SupportPoint>& supports,
                                               const std::vector<ContactPair>& pairs, std::size_t num_bodies);

/// Recovered stress of one body in selected cells.
class BoundaryStress {
 public:
  /// `cells`: active cells in which the stress will be evaluated; min_volume: of the patches (make_patches).
  BoundaryStress(const BodyMesh& mesh, double min_volume, const std::vector<int>& cells);

  /// Recovers from the displacements (all bodies).
  void update(const RealView& u);

  /// Returns n . sigma* . e at cell coordinates of one of the cells; n, e in global axes; units Scales::stress.
  double traction(int cell, const Vec3& xi, const Vec3& n, const Vec3& e) const;

 private:
  const BodyMesh& mesh_;
  RecoveredField field_;
  PatchSet patches_;    ///< of the nodes of field_
  Subset patch_cells_;  ///< cells of these patches
  CellStressView stress_;
};

}  // namespace cgcontact
