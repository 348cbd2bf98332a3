/// Closed surface of triangles that bounds a body. Its triangles are grouped into patches: regions of a named face
/// without creases, which stand for the elementary surfaces of a CSG solid. Read-only after construction, so that
/// threads may share it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Returns neighbour[t][e]: the triangle across the edge from corner e to the next one, -1 where there is none or
/// several.
std::vector<std::array<int, 3>> edge_neighbours(const std::vector<Triangle>& triangles, std::size_t num_points);

/// Returns the nearest point of a triangle, and where it lies: 0 inside, 1 + e on the edge from corner e, 4 + k at
/// corner k.
Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c, int& feature);

class TriangleSurface {
 public:
  /// Closed and oriented outwards (repair_and_check sees to that); `patch`: of every triangle, an index into
  /// `face_names`, the name of the face each patch belongs to.
  TriangleSurface(std::vector<Vec3> points, std::vector<Triangle> triangles, std::vector<int> patch,
                  std::vector<std::string> face_names);

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return topology_->triangles; }
  int patch(int triangle) const { return topology_->patch[triangle]; }
  const std::vector<std::string>& face_names() const { return topology_->face_names; }
  /// Returns the unit outward normal.
  const Vec3& normal(int triangle) const { return normals_[triangle]; }
  const Vec3& corner(int triangle, int k) const { return points_[topology_->triangles[triangle][k]]; }
  /// Returns the triangle across the edge from corner k to the next one, -1 where there is none or several.
  int neighbour(int triangle, int k) const { return topology_->neighbours[triangle][k]; }
  const TriangleTree& tree() const { return tree_; }

  /// Returns the image under x -> scale * rotation * x + translation.
  TriangleSurface transformed(const Mat3& rotation, const Vec3& translation, double scale) const;
  /// Returns the image under x[axis] -> factor * x[axis] + shift.
  TriangleSurface stretched(int axis, double factor, double shift) const;

  /// Point of the surface nearest to a point.
  struct Foot {
    int triangle = -1;  ///< -1: nothing within the limit
    Vec3 point;
    double distance;
    Vec3 normal;  ///< angle-weighted mean of the normals that meet there, not normalised
  };
  /// Returns the nearest foot on one patch, or on all (-1); only feet nearer than `limit`.
  Foot nearest(const Vec3& x, int patch = -1, double limit = 1e300) const;
  /// Returns the unit normal at a point of a triangle, interpolated between the mean normals at its corners; these are
  /// angle-weighted over the triangles of its own patch that are joined there.
  Vec3 smooth_normal(int triangle, const Vec3& point) const;
  /// Returns the triangle with the least distance (in the units of the points) + 1 - cosine of its angle with the unit
  /// vector n.
  int nearest_facing(const Vec3& x, const Vec3& n) const;
  /// Returns whether x is inside or on the surface, by the nearest point and its mean normal (Baerentzen and Aanaes,
  /// Signed distance computation using the angle weighted pseudonormal, IEEE TVCG 11, 2005).
  bool contains(const Vec3& x) const;

  /// Calls use(t, triangle) for all triangles that the line x + t d meets with |t| <= reach; a line through an edge
  /// meets both triangles.
  template <class Use>
  void each_hit(const Vec3& x, const Vec3& d, double reach, const Use& use) const {
    const Vec3 inverse = d.cwiseInverse();
    tree_.visit(
        [&](const Vec3& min, const Vec3& max) {
          double low = -reach, high = reach;
          for (int k = 0; k < 3; ++k) {
            const double slack = hit_tolerance * (1 + max[k] - min[k]);
            if (d[k] == 0) {
              if (x[k] < min[k] - slack || x[k] > max[k] + slack) return false;
              continue;
            }
            const double a = (min[k] - slack - x[k]) * inverse[k], b = (max[k] + slack - x[k]) * inverse[k];
            low = std::max(low, std::min(a, b));
            high = std::min(high, std::max(a, b));
          }
          return low <= high;
        },
        [&](int triangle) {
          double t = 0;
          if (meets(x, d, triangle, t) && std::abs(t) <= reach) use(t, triangle);
        });
  }

 private:
  static constexpr double hit_tolerance = 1e-9;  ///< of barycentric coordinates: lines through edges miss no triangle
  struct Topology {
    std::vector<Triangle> triangles;
    std::vector<std::array<int, 3>> neighbours;
    std::vector<int> patch;
    std::vector<std::string> face_names;
  };

  void find_normals();
  bool meets(const Vec3& x, const Vec3& d, int triangle, double& t) const;
  Vec3 mean_normal(int triangle, int feature) const;
  Vec3 corner_normal(int triangle, int k) const;

  std::shared_ptr<const Topology> topology_;
  std::vector<Vec3> points_, normals_;
  std::vector<Vec3> point_normals_;  ///< angle-weighted
  TriangleTree tree_;
};

}  // namespace cgcontact
