/// A cell is cut into leaves (usually one: the cell itself) in which every curved surface is a graph over a face;
/// facets of surfaces and faces of leaves become regions of a square.
#pragma once

#include <functional>
#include <vector>

#include "core/bodies/local_solid.hpp"
#include "core/cells/boundary_points.hpp"
#include "core/quadrature/region.hpp"

namespace cgcontact {

struct Leaf {
  const CsgBody* solid = nullptr;
  Vec3 corner = Vec3::Zero();
  double width = 1;
  LocalSolid local;
  std::vector<int> axis;        ///< by local surface: it is a graph along this axis
  std::vector<Plane> dividers;  ///< those that cross the leaf
  Vec3 middle = Vec3::Zero();   ///< of the solid

  /// The coordinates s, t, height in which the leaf is integrated `along` an axis (columns of `axes`), from `origin`
  /// on: the coordinate axes in cyclic order, s and t towards the middle of the solid, so that mirror images get mirror
  /// images of the same points.
  struct Frame {
    Mat3 axes;
    Vec3 origin;
  };
  Frame frame(int along) const;
};

/// Visits the leaves of the cell at `corner` that are not wholly outside.
void for_each_leaf(const CsgBody& solid, const LocalSolid& local, const Vec3& corner,
                   const std::vector<Plane>& dividers, const std::function<void(const Leaf&)>& visit);

/// Returns the region of the leaf's upper face across `axis` that is inside, in the frame of that axis.
Region face_region(const Leaf& leaf, int axis);

struct SurfacePoint {
  Vec3 position;
  Vec3 normal;     ///< unit, from the inner to the outer side of the surface
  double stretch;  ///< area of the surface per area of the square
};

/// The facet of the i-th local surface that lies in the leaf and on the body's boundary, as a region of the square
/// across the surface's axis.
class LeafFacet {
 public:
  LeafFacet(const Leaf& leaf, int i);
  bool is_plane() const { return surface_.kind == Surface::Kind::plane; }
  bool is_cone() const { return surface_.kind == Surface::Kind::cone; }
  int axis() const { return axis_; }
  const Vec3& plane_normal() const { return surface_.direction; }
  const Region& region() const { return region_; }
  SurfacePoint at(double s, double t) const;

 private:
  void add_ownership();
  void add_trims();
  void add_dividers();

  const Leaf& leaf_;
  const int index_, axis_;
  const Surface& surface_;
  const Leaf::Frame frame_;
  Vec3 base_, along_s_, along_t_;  ///< of a plane: position = base + s along_s + t along_t
  Region region_;
};

}  // namespace cgcontact
