/// Triangles as they come from a file, before anything is known about them.
#pragma once

#include <string>
#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Facets of a file, first to last, that it gives a name.
struct FacetGroup {
  std::string name;
  int first, last;
};

struct TriangleSoup {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<int> number;              ///< of the facet in the file, from 1; empty: as they stand
  std::vector<int> line;                ///< of the facet in the file; empty: a binary file
  std::vector<FacetGroup> groups = {};  ///< several may have one name, or a facet in common

  /// Names "triangle 7 (line 52) at (x, y, z)": number, line if known, centroid.
  std::string location(int triangle) const;
  bool is_in_group(int triangle, const std::string& name) const;
  /// Keeps the triangles whose entry is not zero.
  void keep(const std::vector<char>& kept);
  /// Removes the triangles whose corners are not three points; returns how many went.
  int drop_collapsed();
  /// Returns the volume of a closed surface: less than zero if its normals point inwards.
  double signed_volume() const;
  /// Returns the diagonal of the box about all points.
  double diagonal() const;
  /// Merges those of some points that are nearer to each other than a distance; returns how many went. Triangles may
  /// collapse.
  int merge(std::vector<int> candidates, double distance);
};

}  // namespace cgcontact
