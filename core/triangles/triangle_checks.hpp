/// Checks that a surface of triangles is the boundary of a body. Small defects with one obvious repair are repaired and
/// counted, others are errors that say what and where.
#pragma once

#include <string>

#include "core/triangles/triangle_soup.hpp"

namespace cgcontact {

/// Repairs, and connected components of the surface.
struct SurfaceRepairs {
  int merged_points = 0;  ///< coincided, or nearly so on open edges
  int zero_area = 0;      ///< triangles without area that went; a neighbour may have been divided for it
  int duplicates = 0;     ///< triangles that were there twice
  bool turned = false;    ///< all normals pointed inwards
  int shells = 1;         ///< connected surfaces, cavities included
  int num_triangles = 0;  ///< that are left
  bool any() const { return merged_points > 0 || zero_area > 0 || duplicates > 0 || turned; }
  /// "2 points merged, surface turned outwards", or "" if nothing was repaired.
  std::string text() const;
};

/// Throws InputError (with the file's name) on open, non-manifold or inconsistently oriented edges, crossing triangles,
/// and shells that are inside out.
SurfaceRepairs repair_and_check(TriangleSoup& soup, const std::string& file);

/// Checks without merging points: those that coincide are meant to be several (shells that touch along an edge).
SurfaceRepairs check_separated(TriangleSoup& soup, const std::string& file);

/// Removes triangles whose corners lie on a line: the neighbour across the longest edge is divided at the corner
/// between. Needles next to each other take several passes. Returns how many went.
int remove_needles(TriangleSoup& soup);
constexpr int max_needle_passes = 20;

}  // namespace cgcontact
