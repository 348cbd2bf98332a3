/// Solids as boolean expressions of elementary surfaces (plane, sphere, infinite cylinder).
/// A box is the intersection of six half-spaces, a cylinder that of one quadric and two half-spaces; surfaces that
/// coincide (same plane, sphere or cylinder up to rounding, either orientation) are merged into one, so that
/// faces shared by several primitives are counted once.
/// Or a solid is bounded by a triangle surface: then its elementary surfaces are the patches of that surface.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/types.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

/// One elementary surface; signed_distance < 0 on its inner side.
struct Surface {
  enum class Kind { plane, sphere, cylinder, patch };
  Kind kind = Kind::plane;
  Vec3 point = Vec3::Zero();       ///< point of the plane, centre of the sphere, point on the axis
  Vec3 direction = Vec3::UnitZ();  ///< unit outward normal of the plane, unit axis of the cylinder
  double radius = 0;               ///< sphere, cylinder
  std::vector<std::string> names;  ///< "primitive.face" names that lie on this surface, e.g. "block.z+"
  std::shared_ptr<const TriangleSurface> triangles;  ///< of a patch
  int patch = -1;

  /// Of a patch: to the plane of its nearest triangle.
  double signed_distance(const Vec3& x) const;
  /// Unit gradient of the signed distance; of a patch the normal interpolated over the nearest triangle.
  Vec3 gradient(const Vec3& x) const;
  /// The surface itself; of a patch the plane of its triangle nearest to x, without names.
  Surface near(const Vec3& x) const;
  /// Parameters t of the intersections of the line x + t d with the surface, ascending; returns 0, 1 or 2 (0 for a
  /// patch: see Solid::crossings).
  int intersect_line(const Vec3& x, const Vec3& d, double t[2]) const;
  /// Upper bound of the principal curvatures.
  double max_curvature() const { return radius > 0 ? 1.0 / radius : 0.0; }
};

/// Boolean expression in postfix order over the signs of the surfaces.
struct BooleanOp {
  enum class Kind { surface, complement_surface, unite, intersect, subtract, empty };
  Kind kind;
  int surface = -1;
};

/// Where a line passes through the boundary of a solid.
struct Crossing {
  double t;
  int surface;
  Vec3 normal;  ///< outward
};

/// A solid: surfaces and the boolean expression that says what is inside.
class Solid {
 public:
  /// Primitives in their own position; `name` prefixes the face names
  /// (box: x- x+ y- y+ z- z+; sphere: surface; cylinder: side bottom top; half-space: plane).
  static Solid box(const Vec3& min, const Vec3& max, const std::string& name);
  static Solid sphere(const Vec3& centre, double radius, const std::string& name);
  /// Finite cylinder from `base` to `top` (centres of its ends).
  static Solid cylinder(const Vec3& base, const Vec3& top, double radius, const std::string& name);
  /// {x : normal . (x - point) <= 0}.
  static Solid half_space(const Vec3& point, const Vec3& normal, const std::string& name);

  /// Bounded by a triangle surface: no boolean operations, evaluate() does not apply.
  static Solid bounded_by(TriangleSurface surface);

  static Solid unite(const Solid& a, const Solid& b);
  static Solid intersect(const Solid& a, const Solid& b);
  static Solid subtract(const Solid& a, const Solid& b);

  /// The image of the solid under x -> scale * rotation * x + translation (scale > 0).
  Solid transformed(const Mat3& rotation, const Vec3& translation, double scale = 1.0) const;

  /// Is x inside (surfaces count as inside of their own half)?
  bool contains(const Vec3& x) const;
  /// Distance to the nearest elementary surface (of a triangle surface: to the boundary).
  double distance_to_surfaces(const Vec3& x) const;
  /// The surface on which a point x of the boundary with the outward normal n lies.
  int surface_at(const Vec3& x, const Vec3& n) const;
  /// Appends the points x + t d, |t| <= reach, where the line enters or leaves the solid, in no order.
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const;
  /// nullptr for a CSG solid.
  const TriangleSurface* triangles() const { return triangles_.get(); }

  /// Value of the boolean expression for given sides (true = inner side) of all surfaces.
  bool evaluate(const std::vector<char>& inner_side) const;
  /// The same when some sides are unknown (-1; 0 outer, 1 inner): 0, 1, or -1 if the value is not determined.
  int evaluate_partial(const std::vector<signed char>& sides) const;

  /// Box that contains the solid; false if the solid is unbounded as far as the primitives tell.
  /// Intersections and differences are bounded by their operands, planes by the half-spaces parallel to the axes.
  bool bounding_box(Vec3& min, Vec3& max) const;

  const std::vector<Surface>& surfaces() const { return surfaces_; }
  const std::vector<BooleanOp>& expression() const { return expression_; }

 private:
  /// Convex hull of points, thickened by a ball or by a disc across an axis; or a half-space.
  struct Hull {
    std::vector<Vec3> points;
    double ball_radius = 0, disc_radius = 0;
    Vec3 axis = Vec3::UnitZ();  ///< of the disc; outward normal of the half-space
    bool half_space = false;
  };
  /// One step of the postfix expression that bounds the solid; surface = index into hulls_.
  using BoundOp = BooleanOp;

  static Solid primitive(const std::vector<Surface>& surfaces, const Hull& hull);
  static Solid combine(const Solid& a, const Solid& b, BooleanOp::Kind kind);
  static std::pair<Vec3, Vec3> hull_bounds(const Hull& hull);
  double length_scale() const;

  std::vector<Surface> surfaces_;
  std::vector<BooleanOp> expression_;
  std::vector<Hull> hulls_;
  std::vector<BoundOp> bounds_;
  std::shared_ptr<const TriangleSurface> triangles_;
};

}  // namespace cgcontact
