/// Limit analysis of a contact with friction: how near a force and a moment are to making it slide as a whole.
#pragma once

#include <vector>

#include "core/base/numbers/types.hpp"
#include "core/geometry/symmetry_plane.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Point of a contact: m, unit normal, and the largest force that friction carries there, mu p A, N.
struct FrictionLimit {
  Vec3 x, normal;
  double force;
};

/// Force (N) and moment about the origin (N m) by which one side holds the other along the faces.
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};

/// What is modelled of a contact that goes on behind planes or around an axis: its motions are symmetric as well.
struct ContactSymmetry {
  std::vector<SymmetryPlane> planes;
  int axis = -1;  ///< of revolution, 0, 1, 2
};

/// Returns the symmetry of contact of a body that goes on behind planes: also of plane strain and of revolution.
ContactSymmetry contact_symmetry(const BodySpec& body, std::vector<SymmetryPlane> planes);

/// Returns the use of friction: the largest ratio, over the rigid motions along the faces, of the work of the wrench to
/// what friction dissipates when all points slide with the motion. At most 1 where the shear of the wrench is at most
/// mu p, and 1 where all points slide with one such motion; above 1 for a wrench that friction cannot carry (kinematic
/// theorem of limit analysis; Goyal, Ruina and Papadopoulos, Wear 143 (1991) 307, the limit surface). 0 without points.
double use_of_friction(const std::vector<FrictionLimit>& points, const Wrench& wrench,
                       const ContactSymmetry& symmetry = {});

}  // namespace cgcontact
