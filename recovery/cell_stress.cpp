#include "recovery/cell_stress.hpp"

#include "core/parallel.hpp"
#include "recovery/corner_differences.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 256;

}  // namespace

CellStress stress_of_displacements(const BodyMesh& mesh, const RealView& u) {
  return [&mesh, u](int cell) {
    double h[8][3];
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i) h[a][i] = u(3 * mesh.cell_nodes[cell][a] + i);
    corner_differences(h);
    constexpr int term[3][4] = {{0, 2, 3, 8}, {0, 1, 3, 9}, {0, 1, 2, 7}};
    double g[Polynomial<2>::num_terms][3][3] = {};
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < 4; ++t)
        for (int i = 0; i < 3; ++i) g[term[j][t]][i][j] = corner_scale[t] * h[corner_difference[j][t]][i];
    CellPolynomial polynomial = CellPolynomial::Zero();
    const double factor = mesh.stress_factor();
    for (int t : {0, 1, 2, 3, 7, 8, 9}) {
      double s[6];
      mesh.law.stress(g[t], s);
      for (int k = 0; k < 6; ++k) polynomial(k, t) = factor * s[k];
    }
    return polynomial;
  };
}

QuadraticCells integrate_quadratic(const BodyMesh& mesh, const CellStress& stress, Subset cells) {
  const CutCells& cc = *mesh.cut_cells;
  QuadraticCells near{std::move(cells), {}, {}};
  near.moments.resize(1 + cc.moments.size());
  near.moments[0] = quartic_moments(full_cell_moments());
  parallel_for(cc.moments.size(), grain, [&](std::size_t c) { near.moments[1 + c] = quartic_moments(cc.moments[c]); });
  near.integrals.resize(near.cells.size());
  parallel_for(near.integrals.size(), grain, [&](std::size_t row) {
    const int cell = near.cells.number(static_cast<int>(row));
    near.integrals[row] = stress(cell) * quadratic_mass(near.moments_of(cc, cell));
  });
  return near;
}

QuadraticSums gather_quadratic(const BodyMesh& mesh, const QuadraticCells& near, const int* cells, int num_cells,
                               const double centre[3]) {
  const CutCells& cc = *mesh.cut_cells;
  QuarticMoments sum{};
  QuadraticSums sums;
  sums.right.setZero();
  for (int c = 0; c < num_cells; ++c) {
    const Index3& cell = cc.cells[cells[c]];
    const double d[3] = {cell[0] + 0.5 - centre[0], cell[1] + 0.5 - centre[1], cell[2] + 0.5 - centre[2]};
    QuarticMoments moments = near.moments_of(cc, cells[c]);
    shift_moments(d, moments);
    for (int m = 0; m < num_quartics; ++m) sum[m] += moments[m];
    const CellPolynomial& h = near.integrals[near.cells.row(cells[c])];
    for (int k = 0; k < 6; ++k) {
      double shifted[Polynomial<2>::num_terms];
      shift_terms(d, h.row(k).data(), shifted);
      for (int t = 0; t < Polynomial<2>::num_terms; ++t) sums.right(k, t) += shifted[t];
    }
  }
  sums.mass = quadratic_mass(sum);
  return sums;
}

}  // namespace cgcontact
