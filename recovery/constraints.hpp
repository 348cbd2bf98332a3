/// The constraint rows C a = Lambda of one patch (paper, equations 4, 5 and 12).
/// Unknowns: 6 components x 4 terms of the node's polynomial in grid axes, then, for contact patches, those of the
/// auxiliary patch of the other body in its own grid axes. Stresses in units of Scales::stress.
#pragma once

#include "core/grid.hpp"
#include "recovery/boundary_data.hpp"
#include "recovery/patches.hpp"

namespace cgcontact {

using Row24 = Eigen::Matrix<double, 1, 6 * num_terms>;

/// Two unit vectors that complete the unit vector n to a right-handed orthonormal frame (n, t1, t2).
std::pair<Vec3, Vec3> tangents(const Vec3& n);

/// Traction R(n) P(d): row of the component along e of sigma n, at offset d from the polynomial's centre.
Row24 traction_row(const Vec3& d, const Vec3& n, const Vec3& e);

/// Divergence rows (equation 4): row i is (div sigma)_i per cell unit; constant for linear polynomials.
Eigen::Matrix<double, 3, 6 * num_terms> divergence_rows();

/// Boundary points of one surface and one kind in a patch, condensed to at most three constraint points
/// that carry the same first and second moments as the group's area (exact for linear tractions).
struct ConstraintGroup {
  int surface = -1;
  int condition = -1;
  int pair = -1;               ///< contact pair, -1 for a group with known traction
  double area = 0;             ///< cell units squared
  std::vector<Vec3> position;  ///< constraint points on the surface, grid coordinates
  std::vector<Vec3> normal;    ///< outward
};

/// Groups of the boundary pieces inside the cells of a patch.
std::vector<ConstraintGroup> constraint_groups(const CutCells& cut_cells, const BoundaryData& boundary,
                                               const int* cells, int num_cells);

}  // namespace cgcontact
