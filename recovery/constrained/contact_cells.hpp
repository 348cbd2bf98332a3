/// Sums over the contact points of each cell: patches are made of cells, and each cell is in eight of them.
#pragma once

#include "recovery/patch/flat_lists.hpp"
#include "recovery/patch/known_pressures.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// Contact point in the rows of patches.
struct PatchContactPoint {
  Vec3 position, normal;  ///< grid coordinates and axes of the body
  double distance;        ///< m, to the other body
  bool pressed;           ///< the pressure on the face is more than zero there; where nothing knows it, it is closed
  Vec3 shear;             ///< direction of friction's shear on the body, unit, where the point slips; else zero
};

/// Contact points of one pair in one cell.
struct ContactFacet {
  int pair = -1, other_body = -1;
  double area = 0, closed_area = 0;       ///< m^2; of points that are pressed
  double unknown_area = 0;                ///< m^2, of the closed area: where no problem on the face knows the pressure
  double cell_size = 0, larger_cell = 0;  ///< m: of the cell, and the largest that meets it
  /// Sums over the points by their area: positions (grid coordinates of each body), outward normals.
  Vec3 position = Vec3::Zero(), other_position = Vec3::Zero(), normal = Vec3::Zero();
  Vec3 low, high;                       ///< box around the points
  int first_point = 0, num_points = 0;  ///< in the list of all points
  int first_under = 0, num_under = 0;   ///< cells of the other body below the points, ascending; in their list
};

/// Lists of facets, points and cells below them, one after the other in the order of the cells.
class ContactCells {
 public:
  /// Sums the contact points by cell. known: may be null. `integrals`: by body; cells below the points count down to
  /// `depth` (cells of the other body at the point) if they are there.
  ContactCells(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals, int index,
               double depth, const KnownPressures* known);

  /// Calls use(facet) for all facets of a pair in these cells, or of all pairs (-1).
  template <class Use>
  void each(const ListRange<int>& cells, int pair, const Use& use) const {
    for (const int cell : cells) {
      const int row = row_of_cell_[cell];
      if (row < 0) continue;
      for (int p = facet_begin_[row]; p < facet_begin_[row + 1]; ++p)
        if (pair < 0 || facets_[p].pair == pair) use(facets_[p]);
    }
  }

  /// Returns the points in the order of the body's contact links.
  ListRange<PatchContactPoint> points(const ContactFacet& facet) const {
    const PatchContactPoint* first = points_.data() + facet.first_point;
    return {first, first + facet.num_points};
  }
  ListRange<int> under(const ContactFacet& facet) const {
    const int* first = under_.data() + facet.first_under;
    return {first, first + facet.num_under};
  }

 private:
  std::vector<int> row_of_cell_, facet_begin_;
  std::vector<ContactFacet> facets_;
  std::vector<PatchContactPoint> points_;
  std::vector<int> under_;
};

}  // namespace cgcontact
