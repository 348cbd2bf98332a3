/// Patches: the cells around each node over which sigma* is fitted (paper, section 2; design section 6).
#pragma once

#include <vector>

#include "kernels/mesh.hpp"

namespace cgcontact {

/// Terms of the complete linear polynomial {1, x, y, z} in cell units about the patch's node.
constexpr int num_terms = 4;
/// Six stress components (xx, yy, zz, xy, yz, zx) times num_terms coefficients of each node's polynomial: (node, 6, 4).
using CoefficientView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, MemSpace>;
/// Moments of each active cell about its centre: volume, x, y, z, xx, yy, zz, xy, yz, zx: (cell, 10), cell units.
using CellMassView = Kokkos::View<double* [10], Kokkos::LayoutRight, MemSpace>;
/// Integrals of {1, x, y, z} sigma_h over each active cell, x about the cell's centre: (cell, 6, 4).
using CellStressView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, MemSpace>;

/// Cells of every node's patch, compressed.
struct PatchSet {
  std::vector<int> begin, cells;  ///< active cells of patch n: cells[begin[n] .. begin[n+1])
  std::vector<char> grown;        ///< joined with a neighbour's patch because it held less than one cell of volume
  IntView begin_view, cells_view;
  CellMassView mass;
  RealView weights;             ///< (1 + cut cells) x 27 fitted weights, entry 0 for interior cells
  IntView weights_of_cell;      ///< active cell -> row of weights
  CellNodesView nodes_of_cell;  ///< active cell -> nodes, in order of the active cells
  Kokkos::View<double*[3], Kokkos::LayoutRight, MemSpace> cell_centre, node_position;  ///< grid coordinates
};

PatchSet make_patches(const BodyMesh& mesh);

}  // namespace cgcontact
