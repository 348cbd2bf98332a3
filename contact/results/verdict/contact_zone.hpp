/// Contact points of a primary body's pairs, with the forces that they transmit and their mirror images behind symmetry
/// planes.
#pragma once

#include "recovery/face/symmetry_planes.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// Force that a contact point transmits; global axes.
struct TransmittedForce {
  int pair, cell;  ///< active cell of the pair's primary body
  int image;       ///< in which planes of symmetry it is mirrored, a bit each; 0: it is no image
  bool closed;
  Vec3 position, normal;  ///< m; outward unit normal of one of the bodies
  double area, force;     ///< m^2; N, compression positive
  double spread_force;    ///< N, where the group's force is spread over all its points, closed or not
  double cell_size;       ///< m, of the larger cell of both bodies there: that of its contact group
};

class ContactZone {
 public:
  ContactZone(const std::vector<RecoveryBody>& bodies, std::size_t index);

  /// Returns the forces without images.
  const std::vector<TransmittedForce>& forces() const { return forces_; }
  /// Returns the images of the points within some cells of a symmetry plane that both bodies of their pair have.
  const std::vector<TransmittedForce>& images() const { return images_; }

  /// Returns the closed points of every cell, pair and image as one point with their mean position and normal; images
  /// last, from the middle of the body outwards.
  std::vector<TransmittedForce> closed_cells() const;

 private:
  void add_images(int pair, const std::vector<SymmetryPlane>& planes);

  Vec3 middle_;  ///< of the body's bounding box
  std::vector<TransmittedForce> forces_, images_;
};

}  // namespace cgcontact
