/// The stress that is recovered, cell by cell: Q1 displacements make it a polynomial of Polynomial<2> in each cell (its
/// square terms are zero), so that all integrals over cut cells follow from their moments.
#pragma once

#include <functional>

#include "kernels/mesh.hpp"
#include "recovery/quartic_moments.hpp"
#include "recovery/subset.hpp"

namespace cgcontact {

/// Component, term of Polynomial<2> about the centre of a cell, cell units; stresses in units of Scales::stress, grid
/// axes.
using CellPolynomial = Eigen::Matrix<double, 6, Polynomial<2>::num_terms, Eigen::RowMajor>;

/// The stress over each active cell of one body. May be called by several threads at once.
using CellStress = std::function<CellPolynomial(int cell)>;

/// sigma_h; u: displacements of all bodies (host).
CellStress stress_of_displacements(const BodyMesh& mesh, const RealView& u);

/// Integrals of the ten terms of Polynomial<2> times the stress over some cells of a body.
struct QuadraticCells {
  Subset cells{0};
  std::vector<CellPolynomial> integrals;  ///< by row of `cells`, about the centre of the cell
  std::vector<QuarticMoments> moments;    ///< 0: full cells, 1 + c: cut cell c

  const QuarticMoments& moments_of(const CutCells& cut_cells, int cell) const {
    return moments[1 + cut_cells.cut_of_active[cell]];
  }
};

QuadraticCells integrate_quadratic(const BodyMesh& mesh, const CellStress& stress, Subset cells);

/// Sums over a patch, shifted to its centre (grid coordinates): mass matrix and right-hand sides by component.
struct QuadraticSums {
  QuadraticMass mass;
  CellPolynomial right;
};
QuadraticSums gather_quadratic(const BodyMesh& mesh, const QuadraticCells& near, const int* cells, int num_cells,
                               const double centre[3]);

}  // namespace cgcontact
