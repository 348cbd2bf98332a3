/// Cells that a closed triangle surface crosses, with the moments of the body in them, and the cells inside. Divergence
/// theorem with a field along x: a facet of the surface adds its integral of (antiderivative along x) n_x to its own
/// cell, and its projection times a whole cell to all cells before it in its row. Rows are swept from the far end, so
/// that whether a cell is inside is a sum of projections, not a decision: facets in any position count once. Where the
/// triangles stand for a curved surface, what lies between a facet and its image is added to the facet's cell (its
/// slivers), and the points are those of the image. The sum over all cells is exact; a sliver may stick out of its
/// cell, where the boundary passes into the next one, by its thickness at most.
#pragma once

#include <utility>
#include <vector>

#include "core/cad/curved_triangles.hpp"
#include "core/cells/cell_sweep.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

class TriangleCells : public CellSweep {
 public:
  /// Finds the cells of all triangles; grid coordinates. Points are made on the facets between the dividers by rules of
  /// `order`, in leaves only; other cells have no meaningful moments. `curved`: what the triangles stand for, nullptr:
  /// themselves. All these must outlive this.
  TriangleCells(const TriangleSurface& surface, const CurvedTriangles* curved, const Index3& num_cells,
                const std::vector<Plane>& dividers, int order, const LeafLevel& leaves);

  GridNumbers take_inside() override { return GridNumbers(num_cells_); }
  /// Counts the rows of cells along x that the surface crosses, by k, j.
  std::size_t num_chunks() const override { return row_begin_.size() - 1; }
  /// Throws InputError where the surface is not closed or does not enclose each volume once.
  void sweep(std::size_t row, SweptCells& found) const override;

 private:
  /// Cell and a triangle with a facet in it; `cell` orders by k, j, i.
  struct Entry {
    long long cell;
    int triangle;
  };

  const TriangleSurface& surface_;
  const CurvedTriangles* const curved_;
  const Index3 num_cells_;
  const std::vector<Plane>& dividers_;
  const int order_;
  const LeafLevel leaves_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> row_begin_;
};

}  // namespace cgcontact
