/// Geometry of a body: all that the rest of the program asks of it. Implemented by boolean expressions of elementary
/// surfaces and by triangle surfaces (core/bodies); another kind of body is another class that derives from this one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/geometry/surface.hpp"

namespace cgcontact {

class CellSweep;
struct BoundaryPoints;
struct Grid;
class CellTree;
struct LeafLevel;
struct Plane;

/// Crossing of a line and the boundary of a solid.
struct Crossing {
  double t;
  int surface;
  Vec3 normal;  ///< outward
};

/// Size of a body on a grid, for the memory forecast.
struct CellEstimate {
  double nodes = 0, cut_cells = 0;
};

/// Read-only after construction: threads share it. Lengths in the units that it was made in: m, or cells once it is
/// placed on a grid.
class BodyGeometry {
 public:
  virtual ~BodyGeometry() = default;

  /// Returns the surfaces that bound it, with the names of the faces that lie on them; elsewhere numbered as here.
  const std::vector<Surface>& surfaces() const { return surfaces_; }

  /// Returns its image under x -> scale * rotation * x + translation (scale > 0).
  virtual std::shared_ptr<const BodyGeometry> transformed(const Mat3& rotation, const Vec3& translation,
                                                          double scale) const = 0;
  /// Returns the same, 2^level times as large, for one level of a refined grid: what follows the surface as closely as
  /// the cells need does so in and around its leaves. level >= 1.
  virtual std::shared_ptr<const BodyGeometry> on_level(int level, const CellTree& tree) const;
  /// Returns the image of a prism along an axis under x[axis] -> factor * x[axis] + shift (factor > 0). Throws
  /// InputError if a surface is neither along the axis nor across it, or lies across it between the prism's ends.
  virtual std::shared_ptr<const BodyGeometry> stretched(int axis, double factor, double shift) const = 0;
  /// Finds a box that contains the body; false if none is known.
  virtual bool bounding_box(Vec3& min, Vec3& max) const = 0;
  /// Returns whether x is inside or on the boundary.
  virtual bool contains(const Vec3& x) const = 0;
  /// Returns the distance to the nearest surface, >= 0.
  virtual double distance_to_surfaces(const Vec3& x) const = 0;
  /// Returns the surface on which a point x of the boundary with the outward normal n lies; its nearest point and
  /// normal are those of the Surface.
  virtual int surface_at(const Vec3& x, const Vec3& n) const = 0;
  /// Appends the points x + t d, |t| <= reach, where the line enters or leaves it, in no order.
  virtual void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const = 0;

  // On a grid.

  /// Returns whether a block of cells is inside (1), outside (0), or unsure (-1). `sides`: by surface, what the blocks
  /// around this one have left about theirs: 1 inner, 0 outer, -1 not known.
  virtual int side_of_block(const Vec3& centre, const Vec3& half_size, std::vector<signed char>& sides) const;
  /// Finds the cells inside and their integrals where the boundary passes (core/cells/cell_sweep.hpp), of a body in
  /// grid coordinates. Boundary facets are cut at the dividers, `order`: of the rule on them (boundary_points_of_cell).
  /// Cells that are no leaves of the level may be left out. This body, grid and dividers must outlive the sweep.
  virtual std::unique_ptr<CellSweep> sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                                 const LeafLevel& leaves) const = 0;
  /// Appends the points on the boundary in one cell, of the surfaces that are `selected`; they belong to the active
  /// cell `owner`.
  virtual void boundary_points(const Index3& cell, const std::vector<char>& selected,
                               const std::vector<Plane>& dividers, int order, int owner,
                               BoundaryPoints& points) const = 0;
  /// Estimates the cells of the body in global axes, m, without making them; from a coarser grid of at most
  /// `max_cells` cells if it needs one.
  virtual CellEstimate estimate_cells(const Grid& grid, double max_cells) const = 0;

  // Counts the facets of a body made of flat ones.

  virtual std::size_t num_facets() const { return 0; }
  /// Returns the width of the narrower of two facets that meet at an angle (at min_angle, radians, or more) although
  /// they stand for one smooth surface, at the facet nearest to x; 0: the surface there is what it stands for.
  virtual double facet_width(const Vec3& x, double min_angle) const;

  // For drawing.

  /// Returns whether the surfaces go on beyond the boundary, so that it takes the sides of all of them to know what is
  /// inside.
  virtual bool has_endless_surfaces() const { return false; }
  /// Returns the candidates (ascending) that may come nearer than `slack` to a cube.
  virtual std::vector<int> surfaces_near(const Vec3& centre, double half_size, double slack,
                                         const std::vector<int>& candidates) const;
  /// Returns whether a convex polyhedron that no surface crosses is inside, by the sides on which it lies of the
  /// surfaces that come near (of all surfaces if they are endless), and by its centroid.
  virtual bool is_inside(const std::vector<char>& inner_side, const std::vector<int>& near, const Vec3& centroid) const;
  /// Returns the distance to the boundary, < 0 inside.
  virtual double signed_distance(const Vec3& x) const;
  /// Returns the surfaces for many searches of one of them alone.
  virtual std::vector<Surface> surfaces_alone() const { return surfaces_; }
  using UseFacet = std::function<void(const Index3& cell, int surface, const Vec3* corners, int num_corners)>;
  /// Calls use for all convex polygons into which the cells of a grid divide the facets, counterclockwise seen from
  /// outside.
  virtual void each_facet_in_cell(const UseFacet& use) const;

 protected:
  std::vector<Surface> surfaces_;
};

}  // namespace cgcontact
