#include "recovery/spr/cell_stress.hpp"

#include <algorithm>

#include "core/base/process/parallel.hpp"
#include "kernels/mesh/mean_dilatation.hpp"
#include "recovery/spr/corner_differences.hpp"
#include "recovery/spr/sum_kernels.hpp"

namespace cgcontact {
CellStress stress_of_displacements(const BodyMesh& mesh, const HostVector& u) {
  return [&mesh, u](int cell) {
    double corner[8][3], h[8][3];
    corner_values(mesh.cell_nodes[cell], u, corner);
    std::copy(&corner[0][0], &corner[0][0] + 24, &h[0][0]);
    corner_differences(h);
    constexpr int term[3][4] = {{0, 2, 3, 8}, {0, 1, 3, 9}, {0, 1, 2, 7}};
    double g[Polynomial<2>::num_terms][3][3] = {};
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < 4; ++t)
        for (int i = 0; i < 3; ++i) g[term[j][t]][i][j] = corner_scale(t) * h[corner_difference(j, t)][i];
    if (const Ring ring = mesh.ring_of(cell); ring.across >= 0) {
      double c[4];
      ring_differences(ring, h, c);
      for (auto& gradient : g) gradient[ring.across][ring.across] = gradient[ring.radial][ring.radial];
      for (int t = 0; t < 4; ++t) g[term[ring.across][t]][ring.across][ring.across] += c[t];
    }
    CellPolynomial polynomial = CellPolynomial::Zero();
    const double factor = mesh.stress_factor(cell);
    const double mean = mean_dilatation(mesh, cell, corner);
    for (int t : {0, 1, 2, 3, 7, 8, 9}) {
      double s[6];
      mesh.law.stress(g[t], t == 0 ? mean : 0, s);
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
    const int cell = out.cells.number(static_cast<int>(row)), slot = out.moments_of_row[row];
    const CellPolynomial polynomial = stress(cell);
    CellPolynomial integrals;
    if (slot == 0) {
      integrals = polynomial * full;
    } else {
      out.moments[slot] = quartic_moments(cc.moments[cc.cut_of_active[cell]]);
      integrals = polynomial * quadratic_mass(out.moments[slot].data());
    }
    out.stress[row] << integrals, Eigen::Matrix<double, 2, Polynomial<2>::num_terms>::Zero();
    out.square[row] = integrals.cwiseProduct(polynomial).sum();
  });
  return out;
}

IntegralArrays<Kokkos::HostSpace> host_arrays(const BodyMesh& mesh, const StressIntegrals& integrals) {
  using Arrays = IntegralArrays<Kokkos::HostSpace>;
  const CutCells& cc = *mesh.cut_cells;
  return {host_arrays(integrals.cells),
          rows_of<decltype(Arrays::stress)>(integrals.stress),
          view_of<decltype(Arrays::square)>(integrals.square),
          rows_of<decltype(Arrays::moments)>(integrals.moments),
          view_of<decltype(Arrays::moments_of_row)>(integrals.moments_of_row),
          rows_of<decltype(Arrays::cells)>(cc.cells),
          view_of<decltype(Arrays::levels)>(cc.levels),
          cc.grid.is_axisymmetric() ? cc.grid.plane_strain : -1};
}

CellSums sum_cells(const BodyMesh& mesh, const StressIntegrals& integrals, const int* cells, int num_cells,
                   const double centre[3], double unit) {
  return host_arrays(mesh, integrals).sum(cells, num_cells, centre, unit);
}

}  // namespace cgcontact
