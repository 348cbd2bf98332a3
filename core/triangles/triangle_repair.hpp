/// Repair on request of surfaces that bound no body as they are: open, crossing, non-manifold, inside out. By CGAL's
/// polygon mesh processing (Loriot et al., Polygon Mesh Processing, CGAL User and Reference Manual); surfaces that
/// cross are cut in exact arithmetic (core/triangles/triangle_arrangement.hpp).
#pragma once

#include <string>
#include <vector>

#include "core/triangles/triangle_soup.hpp"

namespace cgcontact {

/// Changes by a repair. Lengths in the units of the points.
struct SurfaceRepair {
  int merged_points = 0;  ///< equal, or nearer than 1e-4 of the diagonal on open edges
  int turned = 0;         ///< triangles turned over
  int holes = 0;          ///< closed by new triangles
  int united = 0;         ///< shells that overlap, touch or lie in others and are one body with them now
  int lost = 0;           ///< shells without volume, left out
  int untangled = 0;      ///< shells that crossed themselves: cut along the crossings, what was inside left out
  int new_triangles = 0, gone_triangles = 0;
  double volume_before = 0, volume_after = 0, area_before = 0, area_after = 0;
  double distance = 0;       ///< the largest of a new triangle (corners, centroid) from the old surface
  std::vector<char> is_new;  ///< of every triangle: was not in the file
  /// Describes it in one line, for points in metres.
  std::string text() const;
};

/// A surface that was repaired on request, as it was made one.
struct RepairedSurface {
  std::string file, text;  ///< what changed, one line
  TriangleSoup soup;       ///< m, in the axes of the file
  std::vector<char> is_new;
};

/// Makes the triangles the boundary of a body: merges points that nearly coincide on rims, orients neighbours alike,
/// fills holes, cuts shells along their own crossings, unites overlapping ones. A shell whose normals point inwards in
/// a larger one is a cavity. Points of different shells that coincide stay apart: shells may touch along an edge.
/// Throws InputError with the file's name if no closed surface comes out.
SurfaceRepair repair_surface(TriangleSoup& soup, const std::string& file);

}  // namespace cgcontact
