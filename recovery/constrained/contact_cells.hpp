/// What the contact points of each cell add up to: patches are made of cells, and each cell is in eight of them.
#pragma once

#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// The contact points of one pair in one cell.
struct ContactPiece {
  int pair = -1, other_body = -1;
  double area = 0, closed_area = 0;  ///< m^2
  /// Sums over the points by their area: places (grid coordinates of each body), outward normals.
  Vec3 position = Vec3::Zero(), other_position = Vec3::Zero(), normal = Vec3::Zero();
  Vec3 low, high;          ///< box around the points
  std::vector<int> under;  ///< cells of the other body below the points, ascending
};

class ContactCells {
 public:
  /// `integrals`: by body; cells below the points count down to `depth` (cells of the other body) if they are there.
  ContactCells(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals, int index,
               double depth);

  /// use(piece) for all pieces of a pair in these cells, or of all pairs (-1).
  template <class Use>
  void each(const int* cells, int num_cells, int pair, const Use& use) const {
    for (int c = 0; c < num_cells; ++c) {
      const int row = row_of_cell_[cells[c]];
      if (row < 0) continue;
      for (const ContactPiece& piece : pieces_[row])
        if (pair < 0 || piece.pair == pair) use(piece, cells[c]);
    }
  }

 private:
  std::vector<int> row_of_cell_;
  std::vector<std::vector<ContactPiece>> pieces_;
};

}  // namespace cgcontact
