/// The contact points of the pairs that one body is the primary one of, with the forces that they transmit and their
/// mirror images behind symmetry planes.
#pragma once

#include "core/base/point_buckets.hpp"
#include "recovery/spr/recovery_input.hpp"
#include "recovery/zone_edge/edge_fit.hpp"
#include "recovery/zone_edge/symmetry_planes.hpp"

namespace cgcontact {

class ContactZone {
 public:
  ContactZone(const std::vector<RecoveryBody>& bodies, std::size_t index, const EdgeOptions& options = {});

  double largest_cell() const { return largest_cell_; }  ///< m, of those of both bodies that meet; for searches
  /// Without images.
  const std::vector<TransmittedForce>& forces() const { return forces_; }
  /// Of the points within some cells of a symmetry plane that both bodies of their pair have.
  const std::vector<TransmittedForce>& images() const { return images_; }

  /// The points of a pair on a face turned like n, within a distance (m; at most EdgeOptions::reach_of_sums()) of x; no
  /// images.
  std::vector<const TransmittedForce*> forces_near(int pair, const Vec3& x, const Vec3& n, double distance) const;

  /// The closed points of every cell, pair and image as one point with their mean place and normal; images last, from
  /// the middle of the body outwards.
  std::vector<TransmittedForce> closed_cells() const;

 private:
  void add_images(int pair, const std::vector<SymmetryPlane>& planes);

  double largest_cell_ = 0;
  Vec3 middle_;  ///< of the body's bounding box
  std::vector<TransmittedForce> forces_, images_;
  PointBuckets buckets_;
};

}  // namespace cgcontact
