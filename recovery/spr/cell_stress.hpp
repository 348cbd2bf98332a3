/// The stress that is recovered, cell by cell: Q1 displacements make it a polynomial of Polynomial<2> in each cell (its
/// square terms are zero), so that all integrals over cut cells follow from their moments.
#pragma once

#include <functional>

#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/patches.hpp"
#include "recovery/patch/subset.hpp"
#include "recovery/spr/cell_sums.hpp"

namespace cgcontact {

/// Component, term of Polynomial<2> about the centre of a cell, cell units; stresses in units of Scales::stress, grid
/// axes.
using CellPolynomial = Eigen::Matrix<double, 6, Polynomial<2>::num_terms>;

/// The same with two idle components: the components of a term are one vector of the processor.
using PaddedPolynomial = Eigen::Matrix<double, 8, Polynomial<2>::num_terms>;

/// Stress over each active cell of one body. May be called by several threads at once.
using CellStress = std::function<CellPolynomial(int cell)>;

/// Evaluates sigma_h; u: displacements of all bodies.
CellStress stress_of_displacements(const BodyMesh& mesh, const HostVector& u);

/// Integrals over some cells of a body, for polynomials of degree 1 (their first four terms) and 2.
struct StressIntegrals {
  Subset cells{0};
  std::vector<PaddedPolynomial> stress;  ///< the ten terms times the stress, about the centre of the cell; by row
  std::vector<double> square;            ///< stress : stress, cell units; by row
  std::vector<QuarticMoments> moments;   ///< of a full cell, then of the cut cells of the subset
  std::vector<int> moments_of_row;       ///< row -> index in `moments`

  /// Returns whether the integrals over a cell are known.
  bool hold(int cell) const { return cells.row(cell) >= 0; }
};

StressIntegrals integrate_stress(const BodyMesh& mesh, const CellStress& stress, Subset cells);

/// Sums over ascending cells, about a centre; centre and unit of lengths: grid coordinates. The cells count alike,
/// whatever their size. The integrals over all of them are known.
CellSums sum_cells(const BodyMesh& mesh, const StressIntegrals& integrals, const int* cells, int num_cells,
                   const double centre[3], double unit = 1);

}  // namespace cgcontact
