/// Points where the constraints of a patch act: those of a boundary inside its cells, by surface, condition and pair,
/// condensed to a few points with the same moments of area.
#pragma once

#include <tuple>

#include "core/cells/grid.hpp"
#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patches.hpp"
#include "recovery/patch/tangents.hpp"

namespace cgcontact {

/// Boundary points of one surface and one kind in a patch, condensed to a few constraint points that carry the same
/// first and second moments as the group's area: at most three, which determine linear tractions on a plane, for degree
/// 1; at most six, which determine quadratic ones, for degree 2.
struct ConstraintGroup {
  int surface = -1;
  int condition = -1;
  int pair = -1;    ///< contact pair, -1 for a group with known traction
  double area = 0;  ///< grid coordinates squared
  int num_points = 0;
  std::array<Vec3, 6> position;  ///< constraint points on the surface, grid coordinates
  std::array<Vec3, 6> normal;    ///< outward
};

/// The boundary points of one body by cell, surface and kind, condensed to their moments once for all patches.
class BoundaryFacets {
 public:
  BoundaryFacets(const CutCells& cut_cells, const BoundaryData& boundary);

  /// Groups the boundary facets inside the cells of a patch, by surface, condition and pair, without rounding of
  /// tangent faces; points for polynomials of the given degree (0: one point each), which a patch with cells of size
  /// `unit` can distinguish. Of more than 12 facets those below an eighth of the area are joined by direction (60
  /// degrees) into mean planes, whose `surface` is that of the largest facet.
  void groups(const int* cells, int num_cells, int degree, std::vector<ConstraintGroup>& groups, double unit = 1) const;
  std::vector<ConstraintGroup> groups(const int* cells, int num_cells, int degree = 1) const {
    std::vector<ConstraintGroup> found;
    groups(cells, num_cells, degree, found);
    return found;
  }

 private:
  struct Facet {
    int surface, condition, pair;
    double area = 0;
    Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();  ///< normal: integral over the facet
    Mat3 second = Mat3::Zero();                           ///< about the centroid
    bool is_rough = false;                                ///< joined from facets of several surfaces
    auto kind() const { return std::tie(surface, condition, pair); }
  };
  void add_cell(const BoundaryData& boundary, std::size_t begin, std::size_t end, std::vector<Facet>& facets) const;
  static void join_small(std::vector<Facet>& wholes);
  static void join(Facet& whole, const Facet& facet);
  void put_points(const Facet& whole, const Vec3& patch, const Surface& surface, int degree, double unit,
                  ConstraintGroup& group) const;

  const CutCells& cut_cells_;
  const Vec3 middle_;  ///< of the body, grid coordinates
  const double width_of_rounding_;
  std::vector<int> begin_;  ///< cut cell -> first facet, and the end
  std::vector<Facet> facets_;
};

}  // namespace cgcontact
