/// Directions in which bodies press on each other where a convex edge, a corner or a tip of the coarser one meets the
/// other: faces that see each other there are not parallel, and the gap along their normals is not the one that closes.
///
/// Frictionless contact acts along the normal of what is flat, and across both edges where two edges cross. With M the
/// mean of n n^T over a side's normals nearby, 1/n . M^-1 n is small across edges and large for what is a
/// normal of the side. So both sides' are combined like springs in a row:
///   d = (M1^-1 + M2^-1)^-1 (mean n1 - mean n2)
#pragma once

#include <vector>

#include "core/base/numbers/types.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {

/// Sums over points that see another body: their normals, and those of what they see.
struct FacingNormals {
  double area = 0, cosine = 0;   ///< m^2; of the angle between n1 and -n2, times area
  double support = 0;            ///< m^3, of position . normal
  Vec3 position = Vec3::Zero();  ///< m^3
  Vec3 own = Vec3::Zero(), opposite = Vec3::Zero();
  Mat3 own_spread = Mat3::Zero(), opposite_spread = Mat3::Zero();

  void add(double weight, const Vec3& x, const Vec3& normal, const Vec3& opposite_normal);
  /// Returns whether it is a tip, not a cup.
  bool is_tip() const;
  void add(const FacingNormals& other);
  Vec3 direction() const;
};

/// Returns for each cell, with what points of one surface (its index) in it see, the direction of its gap, global axes;
/// zero, where no edge is near: the surface's own normals.
std::vector<Vec3> press_directions(int num_levels, const std::vector<CellIndex>& cells,
                                   const std::vector<int>& surfaces, const std::vector<FacingNormals>& normals);

}  // namespace cgcontact
