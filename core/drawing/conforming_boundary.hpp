/// The boundary of a drawn body without points that hang on the edges of larger triangles.
#pragma once

#include <array>
#include <vector>

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// A triangle of the drawn body's points that is one of its boundary's, a part of it, or stands for it.
struct ThinTriangle {
  std::array<int, 3> points;
  int source;  ///< triangle of the boundary
};

/// Where cells of two sizes meet, the large triangles are divided at the points of the small ones, so that neighbours
/// share whole edges: no pixel is seen through, and each edge of a closed boundary has its opposite.
std::vector<ThinTriangle> conforming_boundary(const DrawnBody& body);

}  // namespace cgcontact
