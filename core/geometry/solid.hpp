/// Body's geometry as a value: copies share what they stand for.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/body_geometry.hpp"

namespace cgcontact {

class TriangleSurface;

/// Its functions are those of BodyGeometry.
class Solid {
 public:
  /// Makes an empty solid.
  Solid();
  explicit Solid(std::shared_ptr<const BodyGeometry> geometry) : geometry_(std::move(geometry)) {}

  /// Primitives in their own position; `name` prefixes the face names
  /// (box: x- x+ y- y+ z- z+; sphere: surface; cylinder and cone: side bottom top; half-space: plane).
  static Solid box(const Vec3& min, const Vec3& max, const std::string& name);
  static Solid sphere(const Vec3& centre, double radius, const std::string& name);
  /// Makes a finite cylinder from `base` to `top` (centres of its ends).
  static Solid cylinder(const Vec3& base, const Vec3& top, double radius, const std::string& name);
  /// Makes a frustum between two circles about the line from `base` to `top`; one radius may be 0 (no face there then).
  /// The radii must differ.
  static Solid cone(const Vec3& base, const Vec3& top, double base_radius, double top_radius, const std::string& name);
  /// Makes {x : normal . (x - point) <= 0}.
  static Solid half_space(const Vec3& point, const Vec3& normal, const std::string& name);
  /// Combine these. Other bodies: combine_triangles (core/bodies/booleans.hpp).
  static Solid unite(const Solid& a, const Solid& b);
  static Solid intersect(const Solid& a, const Solid& b);
  static Solid subtract(const Solid& a, const Solid& b);

  /// Makes a solid bounded by a triangle surface.
  static Solid bounded_by(TriangleSurface surface);

  const BodyGeometry& geometry() const { return *geometry_; }

  /// Throws InputError if the placement is none.
  Solid transformed(const Mat3& rotation, const Vec3& translation, double scale = 1.0) const;
  /// As BodyGeometry::on_level.
  Solid on_level(int level, const CellTree& tree) const { return Solid(geometry_->on_level(level, tree)); }
  Solid stretched(int axis, double factor, double shift) const {
    return Solid(geometry_->stretched(axis, factor, shift));
  }
  const std::vector<Surface>& surfaces() const { return geometry_->surfaces(); }
  bool bounding_box(Vec3& min, Vec3& max) const { return geometry_->bounding_box(min, max); }
  bool contains(const Vec3& x) const { return geometry_->contains(x); }
  double distance_to_surfaces(const Vec3& x) const { return geometry_->distance_to_surfaces(x); }
  int surface_at(const Vec3& x, const Vec3& n) const { return geometry_->surface_at(x, n); }
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const {
    geometry_->crossings(x, d, reach, found);
  }

 private:
  std::shared_ptr<const BodyGeometry> geometry_;
};

}  // namespace cgcontact
