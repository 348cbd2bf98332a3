/// Constraint rows of patches (paper, equations 4, 5, 12, 13): known tractions, zero shear and equal pressure at
/// contact, bonded faces. Host code, for faces, profiles and expressions.
#pragma once

#include "recovery/batched/batched_fit.hpp"
#include "recovery/constrained/boundary_facets.hpp"
#include "recovery/constrained/patch_lists.hpp"

namespace cgcontact {

/// Rows of some patches, in turn.
template <int bodies>
struct RowList {
  std::vector<FitRow<bodies>> rows;
  std::vector<char> firm;  ///< hold to rounding, whatever the other rows ask for: no pressure on an open face
  std::vector<std::pair<int, int>>
      open_sides;  ///< nodes with pressure and contact surfaces that stay traction-free there

  void clear() { rows.clear(), firm.clear(), open_sides.clear(); }
};

class PatchRows {
 public:
  explicit PatchRows(const PatchContext& context)
      : context_(context), facets_(*context.body.mesh->cut_cells, *context.body.boundary) {}

  /// Appends the rows of a patch and sets its kind. bodies = 2: it has an auxiliary patch. groups: work space.
  template <int bodies>
  void add(PatchLists& lists, std::size_t patch, std::vector<ConstraintGroup>& groups, RowList<bodies>& rows) const;

  /// Computes the values of the interior rows (equation 4), num_interior of Polynomial<degree> values. centre, unit: of
  /// the polynomial in that body.
  template <int degree>
  void interior_values(int of_body, const Vec3& centre, double unit, double* values) const;

 private:
  const PatchContext& context_;
  const BoundaryFacets facets_;
};

}  // namespace cgcontact
