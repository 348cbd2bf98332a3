/// Triangles that stand for the faces of a CAD solid: images of triangles of the parameter plane, whose sides on the
/// rim of a face are bent to the rim's curve. The images together are the exact surface. No OpenCASCADE here. Where a
/// face ends in a point (pole of a sphere, tip of a cone) the parameter plane has a line for it: the triangle is the
/// image of a strip between two lines, one for each of its other two corners.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "core/geometry/parametric_surface.hpp"
#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

struct CurvedTriangle {
  /// One side, from corner k to the next one.
  struct Side {
    int edge = -1;          ///< number of the CAD edge it lies on, < 0: inside of the face
    double t0 = 0, t1 = 0;  ///< parameters of the edge at both ends
    int curve = -1;         ///< the edge in the parameter plane (CurvedTriangles::curves), < 0: straight
    int bend = -1;          ///< index into CurvedTriangles::bends, < 0: straight
  };
  int face = 0;
  int pole = -1;      ///< corner that is a line of the parameter plane, < 0: none
  int pole_axis = 0;  ///< 0: that line is along u, 1: along v
  std::array<Vec2, 3> uv;
  std::array<Side, 3> sides;
};

/// Face of the solid: its surface in the units of the file.
struct CurvedFace {
  std::shared_ptr<const ParametricSurface> surface;
  double orientation = 1;  ///< of S_u x S_v: 1 outwards, -1 inwards
};

/// Point on the exact surface, in the coordinates of the triangles.
struct CurvedPoint {
  Vec3 x;
  Vec3 along_a, along_b;  ///< derivatives for the weights a, b of corners 1, 2
  Vec3 normal;            ///< outward unit normal
};

/// Similarity x -> scale * rotation * x + translation.
struct Similarity {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  double scale = 1;

  Vec3 operator()(const Vec3& x) const { return scale * (rotation * x) + translation; }
  Vec3 direction(const Vec3& d) const { return scale * (rotation * d); }
  /// Returns this one after `before`.
  Similarity after(const Similarity& before) const {
    return {rotation * before.rotation, scale * (rotation * before.translation) + translation, scale * before.scale};
  }
};

/// Read-only after refine(): threads share it.
class CurvedTriangles {
 public:
  /// Bent side: distance from the straight one in the parameter plane = s (1 - s) times this polynomial of 2 s - 1, s
  /// from 0 to 1 along the side.
  static constexpr int bend_terms = 7;
  using Bend = std::array<Vec2, bend_terms>;

  std::vector<Vec3> points;  ///< in the placed coordinates
  std::vector<Triangle> corners;
  std::vector<CurvedTriangle> triangles;
  std::vector<CurvedFace> faces;
  std::vector<std::shared_ptr<const PlaneCurve>> curves;
  std::vector<Bend> bends;
  Similarity placement;  ///< from the units of the file

  bool is_plane(int triangle) const { return faces[triangles[triangle].face].surface->is_plane(); }
  /// Returns whether a side of it is bent in the parameter plane, or one of its corners a line. Then its map is no
  /// linear one.
  bool is_bent(int triangle) const;
  /// Parameters at the weights 1 - a - b, a, b of the corners.
  Vec2 parameters(int triangle, double a, double b) const;
  CurvedPoint point_at(int triangle, double a, double b) const;

  /// Returns whether triangles in a box have to follow the surface; an empty function: all have to.
  using Wanted = std::function<bool(const Vec3& low, const Vec3& high)>;
  /// Divides triangles until no side and no middle is farther than `sag` from the exact surface, of those whose boxes
  /// are wanted; computes the bends.
  void refine(double sag, const Wanted& wanted = {});
  /// Returns the largest distance of the middles of the sides of such triangles from the exact surface.
  double largest_sag(const Wanted& wanted = {}) const;
  /// Returns the image; `points` and `placement` move.
  CurvedTriangles moved(const Similarity& motion) const;

 private:
  struct Map {
    Vec2 uv, along_a, along_b;
  };
  /// Numbers of the new points in the middle of sides, -1: none. A side: two points and the CAD edge, or the face; so
  /// that of several triangles is one.
  using SideMiddles = std::map<std::tuple<int, int, int>, int>;
  struct Rim;
  Map map(int triangle, double a, double b) const;
  Vec2 middle_of_side(const CurvedTriangle& triangle, int side) const;
  double sag_of_side(std::size_t triangle, int side) const;
  bool is_wanted(std::size_t triangle, const Wanted& wanted) const;
  bool divide_long_sides(double sag, const Wanted& wanted);
  SideMiddles add_middles(double sag, const Wanted& wanted);
  Rim rim_of(const Triangle& corners_of, const CurvedTriangle& triangle, const SideMiddles& middles) const;
  std::vector<std::array<int, 3>> children_of(const Rim& rim, int pole) const;
  void add_child(const CurvedTriangle& parent, const Rim& rim, const std::array<int, 3>& child);
  void find_bends();
};

/// Projects x to a parametric surface, from a start near the nearest point; false if it is not found.
bool project(const ParametricSurface& surface, const Vec3& x, Vec2& uv, SurfaceJet& jet);
/// Intersects the line x + t d with the surface, from a start near it; false if it is not found.
bool meet(const ParametricSurface& surface, const Vec3& x, const Vec3& d, Vec2& uv, double& t, SurfaceJet& jet);

}  // namespace cgcontact
