#include "core/scene/scene_probe.hpp"

#include <cmath>

namespace cgcontact {

namespace {

// Fractions of the bounding box at which nobody puts a singular point on purpose.
const Vec3 inner_fraction(0.381966011250105, 0.438447187191170, 0.414213562373095);

/// The axis to which the plane is normal, or -1.
int axis_of(const Surface& surface) {
  if (surface.kind != Surface::Kind::plane) return -1;
  for (int k = 0; k < 3; ++k)
    if (std::abs(surface.direction[k]) == 1) return k;
  return -1;
}

}  // namespace

void probe_expressions(const BodySpec& body, const FaceSpec& face, const std::vector<const Expression*>& expressions) {
  Vec3 min, max;
  if (!body.solid.bounding_box(min, max)) return;
  if (face.box) {
    min = min.cwiseMax(face.box->first);
    max = max.cwiseMin(face.box->second);
  }
  const Vec3 inside = min + inner_fraction.cwiseProduct(max - min);
  for (const Surface& surface : body.solid.surfaces()) {
    const int axis = axis_of(surface);
    if (axis < 0) continue;
    Vec3 x = inside;
    x[axis] = surface.point[axis];
    if (!face.contains(surface.names, x, surface.direction) && !face.contains(surface.names, x, -surface.direction))
      continue;
    for (const Expression* expression : expressions) (*expression)(x);
  }
}

}  // namespace cgcontact
