/// Patches: the cells around each node over which sigma* is fitted (paper, section 2). Host code for geometry and
/// edges; kernels for any execution space take views of them (recovery/spr/spr_kernels.hpp).
///
/// Where cells of several sizes meet, only free nodes have patches: all cells that they are a corner of. Polynomials
/// are about their node, in units of the cells of its level: for a free node the largest ones of its patch. The cells
/// of a patch count alike, whatever their size: integrals are over the volume of each cell. A constrained node has the
/// mean of its masters' polynomials, so that sigma* is continuous.
#pragma once

#include <vector>

#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/subset.hpp"

namespace cgcontact {

/// A vector over the degrees of freedom that host code reads.
using HostVector = Kokkos::View<const double*, Kokkos::HostSpace>;
/// Terms of the complete linear polynomial {1, x, y, z} in cell units about the patch's node.
constexpr int num_terms = 4;
/// Six stress components (xx, yy, zz, xy, yz, zx) times num_terms coefficients of each node's polynomial: (node, 6, 4).
using CoefficientView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, Kokkos::HostSpace>;
/// Integrals of {1, x, y, z} sigma_h over each active cell, x about the cell's centre, cell units: (cell, 6, 4).
using CellStressView = Kokkos::View<double* [6][num_terms], Kokkos::LayoutRight, Kokkos::HostSpace>;
/// Integrals over the material in a cell, about the cell's centre, cell units: 1, x, y, z, xx, yy, zz, xy, yz, zx, xyz,
/// xxy, xxz, xyy, yyz, xzz, yzz.
using MonomialMoments = std::array<double, 17>;

/// Cells of every node's patch, compressed.
struct PatchSet {
  std::vector<int> begin, cells;         ///< active cells of patch n: cells[begin[n] .. begin[n+1]); constrained: none
  std::vector<char> grown;               ///< joined with a neighbour's patch: it held too little volume
  std::vector<char> full;                ///< eight cells of one size, all of them interior
  std::vector<MonomialMoments> moments;  ///< 0: interior cells, 1 + c: cut cell c
  std::vector<int> factor_of_patch;      ///< row of `factors`, -1: full, or no patch
  /// Cholesky factors of the mass matrices of the patches that are not full, about their nodes: the lower triangle by
  /// rows. Of a singular one the first entry is its volume, negative.
  std::vector<std::array<double, 10>> factors;

  const MonomialMoments& moments_of(const CutCells& cut_cells, int cell) const {
    return moments[1 + cut_cells.cut_of_active[cell]];
  }
};

/// Calls use(node, weight) for the nodes (of the body) with patches of their own that a node stands for: itself if it
/// is free.
template <class Use>
void each_master(const BodyMesh& mesh, int node, const Use& use) {
  if (mesh.is_free(node)) return use(node, 1.0);
  for (const auto& [master, weight] : mesh.constraints[mesh.constraint_of_node[node]].masters)
    use(master - mesh.first_node, weight);
}

/// Returns the level whose cells are the unit of a node's polynomial; that unit, grid coordinates.
inline int level_of(const BodyMesh& mesh, int node) { return mesh.node_levels.empty() ? 0 : mesh.node_levels[node]; }
inline double unit_of(const BodyMesh& mesh, int node) { return std::ldexp(1.0, -level_of(mesh, node)); }

/// Marks the nodes of a cell and the masters of those that are constrained.
void mark_nodes(const BodyMesh& mesh, int cell, std::vector<char>& marked);

/// Makes the patches. min_volume: cells; smaller patches are joined with a neighbour's.
PatchSet make_patches(const BodyMesh& mesh, double min_volume = 1);
/// Makes the patches of some nodes only; the others have no cells.
PatchSet make_patches(const BodyMesh& mesh, double min_volume, const Subset& nodes);
/// Makes the patches of several bodies.
std::vector<PatchSet> make_patches(const std::vector<BodyMesh>& meshes, double min_volume);

}  // namespace cgcontact
