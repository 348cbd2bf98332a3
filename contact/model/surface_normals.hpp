/// Exact normals of a body's surfaces, where quadrature points have those of their facet.
#pragma once

#include <vector>

#include "contact/model/model.hpp"

namespace cgcontact {

class SurfaceNormals {
 public:
  /// The body must outlive this.
  explicit SurfaceNormals(const BodyModel& body);
  /// Returns the unit normal, global axes, of the surface in the active cell that is nearest to a point x in grid
  /// coordinates; outward, but inward for surfaces of a subtracted shape.
  Vec3 operator()(int cell, const Vec3& x) const;

 private:
  const BodyModel& body_;
  std::vector<std::vector<int>> surfaces_of_cell_;
};

}  // namespace cgcontact
