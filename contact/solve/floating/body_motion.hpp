/// Motions without stress, kept apart from the displacements. A stiff body on a soft one moves by far more than it
/// deforms: in one number the strain is lost in rounding (ten digits of sixteen for moduli 1e6 apart). The free thermal
/// expansion is such a motion as well: what is left strains the body as its stress does, so nothing else knows of
/// temperatures.
#pragma once

#include <vector>

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// u(x) = translation + rotation x (x - centre) + expansion (x - centre), m, global axes; small rotation. In global
/// axes a motion along one of them has no rounding in the other two, which supports hold with kappa E/h.
struct BodyMotion {
  Vec3 translation = Vec3::Zero(), rotation = Vec3::Zero();
  Mat3 expansion = Mat3::Zero();  ///< given: BodyModel::expansion
  Vec3 centre = Vec3::Zero();     ///< mean of the nodes

  KOKKOS_INLINE_FUNCTION Vec3 at(const Vec3& x) const {
    return translation + rotation.cross(x - centre) + expansion * (x - centre);
  }
};

/// Rigid motions of all bodies.
class BodyMotions {
 public:
  /// The meshes must outlive this.
  BodyMotions(const std::vector<BodyMesh>& meshes, const Scales& scales);

  const std::vector<BodyMotion>& of_bodies() const { return motions_; }
  /// Sets the thermal expansion of one body.
  void set_expansion(std::size_t body, const Mat3& expansion) { motions_[body].expansion = expansion; }
  /// Resets all motions to the expansions.
  void forget();
  /// Returns the same for kernels.
  Kokkos::View<const BodyMotion*, MemSpace> on_device() const;
  /// Moves the rigid motion nearest to each body's displacements u (Scales::length; least squares over its nodes) from
  /// u here.
  void set_aside(const ExecSpace& exec, const RealView& u);
  /// Adds the motion x -> translation + rotation x (x - centre), m, global axes, of one body.
  void move(std::size_t body, const Vec3& translation, const Vec3& rotation, const Vec3& centre);
  /// Returns a bound of the displacements' components, u and rigid motions together, Scales::length.
  double largest_displacement(const ExecSpace& exec, const RealView& u) const;

 private:
  const std::vector<BodyMesh>& meshes_;
  double length_;
  std::vector<BodyMotion> motions_;
  std::vector<Vec3> centre_;   ///< mean of the nodes, cells
  std::vector<Mat3> inertia_;  ///< sum over the nodes of |d|^2 I - d d^T, d from the centre, cells
};

}  // namespace cgcontact
