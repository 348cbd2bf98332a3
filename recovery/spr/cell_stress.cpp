#include "recovery/spr/cell_stress.hpp"

#include "core/base/parallel.hpp"
#include "recovery/spr/corner_differences.hpp"

namespace cgcontact {
CellStress stress_of_displacements(const BodyMesh& mesh, const HostVector& u) {
  return [&mesh, u](int cell) {
    double h[8][3];
    corner_values(mesh.cell_nodes[cell], u, h);
    corner_differences(h);
    constexpr int term[3][4] = {{0, 2, 3, 8}, {0, 1, 3, 9}, {0, 1, 2, 7}};
    double g[Polynomial<2>::num_terms][3][3] = {};
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < 4; ++t)
        for (int i = 0; i < 3; ++i) g[term[j][t]][i][j] = corner_scale(t) * h[corner_difference(j, t)][i];
    CellPolynomial polynomial = CellPolynomial::Zero();
    const double factor = mesh.stress_factor(cell);
    for (int t : {0, 1, 2, 3, 7, 8, 9}) {
      double s[6];
      mesh.law.stress(g[t], s);
      for (int k = 0; k < 6; ++k) polynomial(k, t) = factor * s[k];
    }
    return polynomial;
  };
}

StressIntegrals integrate_stress(const BodyMesh& mesh, const CellStress& stress, Subset cells) {
  const CutCells& cc = *mesh.cut_cells;
  StressIntegrals out{std::move(cells), {}, {}, {}, {}};
  const std::size_t size = out.cells.size();
  int count = 1;
  out.moments_of_row.resize(size);
  for (std::size_t row = 0; row < size; ++row)
    out.moments_of_row[row] = cc.cut_of_active[out.cells.number(static_cast<int>(row))] < 0 ? 0 : count++;
  out.moments.resize(count);
  out.moments[0] = quartic_moments(full_cell_moments());
  const QuadraticMass full = quadratic_mass(out.moments[0].data());
  out.stress.resize(size);
  out.square.resize(size);
  parallel_for("cgcontact::cell_stress::integrals", size, grain_of_medium, [&](std::size_t row) {
    const int cell = out.cells.number(static_cast<int>(row)), place = out.moments_of_row[row];
    const CellPolynomial polynomial = stress(cell);
    CellPolynomial integrals;
    if (place == 0) {
      integrals = polynomial * full;
    } else {
      out.moments[place] = quartic_moments(cc.moments[cc.cut_of_active[cell]]);
      integrals = polynomial * quadratic_mass(out.moments[place].data());
    }
    out.stress[row] << integrals, Eigen::Matrix<double, 2, Polynomial<2>::num_terms>::Zero();
    out.square[row] = integrals.cwiseProduct(polynomial).sum();
  });
  return out;
}

namespace {

/// Over cells of one level, which is the unit of the centre and the sums.
CellSums sum_cells_of_level(const CutCells& cc, const StressIntegrals& integrals, const int* cells, int num_cells,
                            const double centre[3]) {
  CellSums total{};
  for (int i = 0; i < num_cells;) {
    const int z = cc.cells[cells[i]][2];
    CellSums layer{};
    while (i < num_cells && cc.cells[cells[i]][2] == z) {
      const int y = cc.cells[cells[i]][1];
      CellSums line{};
      for (; i < num_cells; ++i) {
        const Index3& cell = cc.cells[cells[i]];
        if (cell[1] != y || cell[2] != z) break;
        const int row = integrals.cells.row(cells[i]);
        line.add<0>(integrals.stress[row].data(), integrals.moments[integrals.moments_of_row[row]].data(),
                    integrals.square[row], cell[0] + 0.5 - centre[0]);
      }
      layer.add<1>(line, y + 0.5 - centre[1]);
    }
    total.add<2>(layer, z + 0.5 - centre[2]);
  }
  return total;
}

}  // namespace

CellSums sum_cells(const BodyMesh& mesh, const StressIntegrals& integrals, const int* cells, int num_cells,
                   const double centre[3], double unit) {
  const CutCells& cc = *mesh.cut_cells;
  if (cc.levels.empty()) return sum_cells_of_level(cc, integrals, cells, num_cells, centre);
  CellSums total{};
  for (int first = 0; first < num_cells;) {
    const double size = cc.size(cells[first]);
    int end = first + 1;
    while (end < num_cells && cc.level(cells[end]) == cc.level(cells[first])) ++end;
    const double centre_of_level[3] = {centre[0] / size, centre[1] / size, centre[2] / size};
    total.add_scaled(sum_cells_of_level(cc, integrals, cells + first, end - first, centre_of_level), size / unit);
    first = end;
  }
  return total;
}

}  // namespace cgcontact
