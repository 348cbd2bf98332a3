/// Bodies as boolean expressions of elementary surfaces (plane, sphere, infinite cylinder, cone). A box is the
/// intersection of six half-spaces, a cylinder that of one quadric and two half-spaces; coincident surfaces (same
/// plane, sphere or cylinder up to rounding, either orientation) are merged, so that shared faces are counted once.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/geometry/solid.hpp"

namespace cgcontact {

/// Boolean expression in postfix order over the signs of the surfaces.
struct BooleanOp {
  enum class Kind { surface, complement_surface, unite, intersect, subtract, empty };
  Kind kind;
  int surface = -1;
};

class CsgBody final : public BodyGeometry {
 public:
  /// Convex hull of points, thickened by a ball or by a disc across an axis; or a half-space.
  struct Hull {
    std::vector<Vec3> points;
    double ball_radius = 0, disc_radius = 0;
    Vec3 axis = Vec3::UnitZ();  ///< of the disc; outward normal of the half-space
    bool half_space = false;
  };

  /// Makes an empty body.
  CsgBody() = default;
  /// Intersects the inner sides of all surfaces, in a hull.
  CsgBody(std::vector<Surface> surfaces, Hull hull);
  /// Combines the surfaces by an expression, in a hull.
  CsgBody(std::vector<Surface> surfaces, std::vector<BooleanOp> expression, Hull hull);
  /// Makes a kind b.
  CsgBody(const CsgBody& a, const CsgBody& b, BooleanOp::Kind kind);

  /// Returns the same body, known to be in a hull.
  CsgBody bounded_by(Hull hull) const;

  /// Returns the boolean expression for given sides (true = inner side) of all surfaces.
  bool evaluate(const std::vector<char>& inner_side) const;
  /// Returns the same when some sides are unknown (-1; 0 outer, 1 inner): 0, 1, or -1 if the value is not determined.
  int evaluate_partial(const std::vector<signed char>& sides) const;
  const std::vector<BooleanOp>& expression() const { return expression_; }

  std::shared_ptr<const BodyGeometry> transformed(const Mat3& rotation, const Vec3& translation,
                                                  double scale) const override;
  std::shared_ptr<const BodyGeometry> stretched(int axis, double factor, double shift) const override;
  /// Intersections and differences are bounded by their operands, planes by the half-spaces parallel to the axes.
  bool bounding_box(Vec3& min, Vec3& max) const override;
  bool contains(const Vec3& x) const override;
  double distance_to_surfaces(const Vec3& x) const override;
  int surface_at(const Vec3& x, const Vec3& n) const override;
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const override;

  int side_of_block(const Vec3& centre, const Vec3& half_size, std::vector<signed char>& sides) const override;
  std::unique_ptr<CellSweep> sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                         const LeafLevel& leaves) const override;
  void boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>& dividers,
                       int order, int owner, BoundaryPoints& points) const override;
  CellEstimate estimate_cells(const Grid& grid, double max_cells) const override;

  bool has_endless_surfaces() const override { return true; }
  bool is_inside(const std::vector<char>& inner_side, const std::vector<int>&, const Vec3&) const override {
    return evaluate(inner_side);
  }

 private:
  /// One step of the postfix expression that bounds the body; surface = index into hulls_.
  using BoundOp = BooleanOp;

  void merge_surfaces(const CsgBody& b, double length, std::vector<int>& index, std::vector<char>& flipped);
  void append_expression(const CsgBody& b, const std::vector<int>& index, const std::vector<char>& flipped);
  double length_scale() const;

  std::vector<BooleanOp> expression_;
  std::vector<Hull> hulls_;
  std::vector<BoundOp> bounds_;
};

/// Throws InputError if a cone is too flat or too slim to be integrated.
void check_cone(const Surface& cone);

/// Returns nullptr for bodies of another kind.
const CsgBody* as_csg(const Solid& solid);

}  // namespace cgcontact
