/// Cells of a grid (or of one level of it) that a body fills or crosses, found in independent chunks.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "core/cells/boundary_points.hpp"
#include "core/cells/cell_classification.hpp"
#include "core/cells/moments.hpp"

namespace cgcontact {

/// Integrals in one cell that the boundary may cross.
struct CellIntegrals {
  Index3 cell;
  Moments moments;
  BoundaryPoints points;  ///< `points.cell` is not set
  /// The body in the cell is so thin that its moments need not be those of a positive measure: it is joined with a
  /// neighbour whatever its volume.
  bool thin = false;
};

struct SweptCells {
  std::vector<CellIntegrals> crossed;          ///< by the boundary, or empty or full
  std::vector<std::pair<Index3, int>> inside;  ///< first cell, number of cells along x
};

class CellSweep {
 public:
  virtual ~CellSweep() = default;
  /// Returns cells that are known to be inside before the sweep. Called once.
  virtual GridNumbers take_inside() = 0;
  /// Counts the chunks, which are in the order of the cells, by k, j, i.
  virtual std::size_t num_chunks() const = 0;
  /// Appends the cells of a chunk; different threads may sweep different chunks. Throws InputError.
  virtual void sweep(std::size_t chunk, SweptCells& found) const = 0;
};

/// Sweep of bodies that know the side of a block of cells (BodyGeometry::side_of_block) and integrate single cells.
class CellByCell : public CellSweep {
 public:
  /// Appends what one cell that the boundary may cross holds.
  using Integrate = std::function<void(const Index3& cell, SweptCells& found)>;

  CellByCell(const BodyGeometry& body, const Grid& grid, const LeafLevel& leaves, Integrate integrate)
      : classes_(classify_cells(body, grid, leaves)), integrate_(std::move(integrate)) {}
  GridNumbers take_inside() override { return std::move(classes_.inside); }
  std::size_t num_chunks() const override { return (classes_.candidates.size() + grain - 1) / grain; }
  void sweep(std::size_t chunk, SweptCells& found) const override {
    const std::size_t end = std::min((chunk + 1) * grain, classes_.candidates.size());
    for (std::size_t i = chunk * grain; i < end; ++i) integrate_(classes_.candidates[i], found);
  }

 private:
  static constexpr std::size_t grain = 16;
  CellClasses classes_;
  Integrate integrate_;
};

}  // namespace cgcontact
