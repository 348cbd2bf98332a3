/// Patches: the cells around each node over which sigma* is fitted (paper, section 2).
/// What reads these, geometry and edges, is host code; kernels for any execution space take views of them
/// (recovery/spr/spr_kernels.hpp).
#pragma once

#include <vector>

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// A vector over the degrees of freedom that host code reads.
using HostVector = Kokkos::View<const double*, Kokkos::HostSpace>;
/// Terms of the complete linear polynomial {1, x, y, z} in cell units about the patch's node.
constexpr int num_terms = 4;
/// Six stress components (xx, yy, zz, xy, yz, zx) times num_terms coefficients of each node's polynomial: (node, 6, 4).
using CoefficientView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, Kokkos::HostSpace>;
/// Integrals of {1, x, y, z} sigma_h over each active cell, x about the cell's centre: (cell, 6, 4).
using CellStressView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, Kokkos::HostSpace>;
/// Integrals over the body's part of a cell, about the cell's centre, cell units:
/// 1, x, y, z, xx, yy, zz, xy, yz, zx, xyz, xxy, xxz, xyy, yyz, xzz, yzz.
using MonomialMoments = std::array<double, 17>;

/// Cells of every node's patch, compressed.
struct PatchSet {
  std::vector<int> begin, cells;         ///< active cells of patch n: cells[begin[n] .. begin[n+1])
  std::vector<char> grown;               ///< joined with a neighbour's patch: it held too little volume
  std::vector<char> full;                ///< eight cells, all of them interior
  std::vector<MonomialMoments> moments;  ///< 0: interior cells, 1 + c: cut cell c
  std::vector<int> factor_of_patch;      ///< row of `factors`, -1: full
  /// Cholesky factors of the mass matrices of the patches that are not full, about their nodes: the lower triangle by
  /// rows. Of a singular one the first entry is its volume, negative.
  std::vector<std::array<double, 10>> factors;

  const MonomialMoments& moments_of(const CutCells& cut_cells, int cell) const {
    return moments[1 + cut_cells.cut_of_active[cell]];
  }
};

/// least_volume: cells; smaller patches are joined with a neighbour's.
PatchSet make_patches(const BodyMesh& mesh, double least_volume = 1);

/// Marks the active cells at most `reach` cells away from any of the given ones along every axis.
void mark_around(const CutCells& cut_cells, std::vector<Index3> cells, int reach, std::vector<char>& marked);

}  // namespace cgcontact
