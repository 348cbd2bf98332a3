/// Boundary of a drawn body without points that hang on the edges of larger triangles.
#pragma once

#include <array>
#include <vector>

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// Triangle of the drawn body's points that is one of its boundary's, a fragment of it, or stands for it.
struct ThinTriangle {
  std::array<int, 3> points;
  int source;  ///< triangle of the boundary
};

/// Divides large triangles at the points of small ones where cells of two sizes meet, so that neighbours share whole
/// edges: no pixel is seen through, and each edge of a closed boundary has its opposite.
std::vector<ThinTriangle> conforming_boundary(const DrawnBody& body);

}  // namespace cgcontact
