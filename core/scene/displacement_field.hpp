/// Displacement of one body of a finished run, from its result directory: what a support with displacement_from
/// prescribes. It is that of the cells in result.vtkhdf: in full ones trilinear, the finite element solution; in the
/// tetrahedra of cut ones linear between its values at their corners. The file holds it in single precision.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"
#include "core/scene/scene.hpp"
#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Read-only after construction, so that threads may share it.
class DisplacementField {
 public:
  /// Reads the field of the body that has the name of this one, and must be computed as it is: in three dimensions, in
  /// plane strain or as a body of revolution. Throws InputError (without location) if the directory has no such field.
  DisplacementField(const std::string& directory, const BodySpec& body);

  struct Value {
    Vec3 displacement;  ///< m, global axes
    double distance;    ///< m, of the place that has it
  };
  /// Returns the value at the place of the body nearest to x (m, global axes).
  Value at(Vec3 x) const;
  /// Returns the size of the largest cells of the body, m.
  double cell_size() const { return cell_size_; }

 private:
  /// A place in a cell: a weighted mean of its corners.
  struct Place {
    Vec3 x;
    std::array<double, 8> shares;
  };

  void read_cells(const std::string& file, int body);
  void make_tree();
  int num_corners(int cell) const { return first_corner_[cell + 1] - first_corner_[cell]; }
  const Vec3& corner(int cell, int k) const { return points_[corners_[first_corner_[cell] + k]]; }
  Place nearest_in_box(int cell, const Vec3& x) const;
  Place nearest_in_tetrahedron(int cell, const Vec3& x) const;
  std::array<double, 8> shares_in_tetrahedron(int cell, const Vec3& x) const;

  double cell_size_ = 0;
  int across_ = -1;                  ///< axis along which nothing varies, -1: none
  std::vector<Vec3> points_;         ///< m
  std::vector<Vec3> displacements_;  ///< of the points, m
  std::vector<int> corners_;         ///< points of the cells: eight of a box, four of a tetrahedron, VTK order
  std::vector<int> first_corner_;    ///< of each cell, with an end
  TriangleTree tree_;                ///< of the boxes around the cells
};

}  // namespace cgcontact
