/// Quadrature points on the boundary of a body, and the planes that divide its facets. Grid coordinates.
#pragma once

#include <memory>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

struct Plane {
  Vec3 normal;
  double offset;                                                ///< normal . x = offset
  std::shared_ptr<const std::vector<char>> surfaces = nullptr;  ///< as a divider: cuts the facets of these only
  /// As a divider of facets: x is their unit normal, so that it separates those in a cone from the others.
  bool of_normals = false;

  bool divides(int surface) const { return !surfaces || (*surfaces)[surface]; }
};

/// Returns whether one of the planes is the border of a face. Then points know their facets
/// (BoundaryPoints::facet_position).
bool divide_faces(const std::vector<Plane>& dividers);

/// Returns the planes that cross the cube [corner, corner + width]^3, and those of normals.
std::vector<Plane> crossing_planes(const std::vector<Plane>& planes, const Vec3& corner, double width);

/// Points on the boundary, all vectors of the same length. Positions, normals in grid coordinates, weights in cell
/// units squared (sum of weights = area / h^2).
struct BoundaryPoints {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;  ///< outward unit normal
  std::vector<double> weight;
  std::vector<int> cell;     ///< active cell that the point belongs to (index into CutCells::cells)
  std::vector<int> surface;  ///< index into solid.surfaces()
  /// Means over the point's facet (between dividers), which decide the side of the dividers: a point itself
  /// may be on one but for rounding. Empty in bodies without face dividers.
  std::vector<Vec3> facet_position, facet_normal;
  std::size_t size() const { return weight.size(); }
  void append(const Vec3& x, const Vec3& n, double w, int owner, int on_surface) {
    position.push_back(x);
    normal.push_back(n);
    weight.push_back(w);
    cell.push_back(owner);
    surface.push_back(on_surface);
  }
  void reserve(std::size_t n) {
    position.reserve(n);
    normal.reserve(n);
    weight.reserve(n);
    cell.reserve(n);
    surface.reserve(n);
    if (!facet_position.empty()) {
      facet_position.reserve(n);
      facet_normal.reserve(n);
    }
  }
  /// Keeps the first n points.
  void truncate(std::size_t n) {
    position.resize(n);
    normal.resize(n);
    weight.resize(n);
    cell.resize(n);
    surface.resize(n);
    if (!facet_position.empty()) {
      facet_position.resize(n);
      facet_normal.resize(n);
    }
  }
  /// Sets the facet of the last point.
  void set_facet(const Vec3& mean_position, const Vec3& mean_normal) {
    facet_position.push_back(mean_position);
    facet_normal.push_back(mean_normal);
  }
  const Vec3& position_of_facet(std::size_t i) const {
    return facet_position.empty() ? position[i] : facet_position[i];
  }
  const Vec3& normal_of_facet(std::size_t i) const { return facet_normal.empty() ? normal[i] : facet_normal[i]; }
  template <class Packing>
  void pack(Packing& to) const {
    to.put(position);
    to.put(normal);
    to.put(weight);
    to.put(surface);
    to.put(facet_position);
    to.put(facet_normal);
  }
  /// Unpacks all but `cell`.
  template <class Unpacking>
  void unpack(Unpacking& from) {
    from.take(position);
    from.take(normal);
    from.take(weight);
    from.take(surface);
    from.take(facet_position);
    from.take(facet_normal);
    cell.assign(weight.size(), -1);
  }
  /// Appends point i of another set, owned by `owner`.
  void append(const BoundaryPoints& from, std::size_t i, int owner) {
    append(from.position[i], from.normal[i], from.weight[i], owner, from.surface[i]);
    if (!from.facet_position.empty()) set_facet(from.facet_position[i], from.facet_normal[i]);
  }
};

}  // namespace cgcontact
