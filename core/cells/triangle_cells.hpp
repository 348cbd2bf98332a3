/// The cells that a closed triangle surface crosses, with the moments of the body in them, and the cells inside.
/// Divergence theorem with a field along x: a piece of surface adds its integral of (antiderivative along x) n_x to its
/// own cell, and its projection times a whole cell to all cells before it in its row. Cells are swept from the far end
/// of each row, so that whether a cell is inside is a sum of projections, not a decision: pieces in any position count
/// once.
#pragma once

#include <utility>
#include <vector>

#include "core/cells/cell_pieces.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

class TriangleCells {
 public:
  /// Finds the cells of all triangles; grid coordinates. Points are made on the pieces between the dividers.
  TriangleCells(const TriangleSurface& surface, const std::vector<Plane>& dividers);

  /// Rows of cells along x that the surface crosses, by k, j.
  std::size_t num_rows() const { return row_begin_.size() - 1; }
  /// Appends the cells of a row that the surface crosses, by i, and the ranges of cells inside (first cell, number).
  /// Throws InputError where the surface is not closed or does not enclose each volume once.
  void sweep(std::size_t row, int order, std::vector<CellIntegrals>& cells,
             std::vector<std::pair<Index3, int>>& inside) const;

 private:
  /// A cell and a triangle with a piece in it; `cell` orders by k, j, i.
  struct Entry {
    long long cell;
    int triangle;
  };

  const TriangleSurface& surface_;
  const std::vector<Plane>& dividers_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> row_begin_;
};

}  // namespace cgcontact
