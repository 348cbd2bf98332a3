#include "recovery/spr/cell_stress.hpp"

#include "core/base/parallel.hpp"
#include "kernels/simd/lane_math.hpp"
#include "recovery/spr/corner_differences.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 256;

}  // namespace

CellStress stress_of_displacements(const BodyMesh& mesh, const RealView& u) {
  return [&mesh, u](int cell) {
    double h[8][3];
    corner_values(mesh.cell_nodes[cell], u, h);
    corner_differences(h);
    constexpr int term[3][4] = {{0, 2, 3, 8}, {0, 1, 3, 9}, {0, 1, 2, 7}};
    double g[Polynomial<2>::num_terms][3][3] = {};
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < 4; ++t)
        for (int i = 0; i < 3; ++i) g[term[j][t]][i][j] = corner_scale[t] * h[corner_difference[j][t]][i];
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
  const QuadraticMass full = quadratic_mass(out.moments[0]);
  out.stress.resize(size);
  out.square.resize(size);
  parallel_for("cgcontact::cell_stress::integrals", size, grain, [&](std::size_t row) {
    const int cell = out.cells.number(static_cast<int>(row)), place = out.moments_of_row[row];
    const CellPolynomial polynomial = stress(cell);
    CellPolynomial integrals;
    if (place == 0) {
      integrals = polynomial * full;
    } else {
      out.moments[place] = quartic_moments(cc.moments[cc.cut_of_active[cell]]);
      integrals = polynomial * quadratic_mass(out.moments[place]);
    }
    out.stress[row] << integrals, Eigen::Matrix<double, 2, Polynomial<2>::num_terms>::Zero();
    out.square[row] = integrals.cwiseProduct(polynomial).sum();
  });
  return out;
}

QuadraticSums gather_quadratic(const BodyMesh& mesh, const StressIntegrals& integrals, const int* cells, int num_cells,
                               const double centre[3]) {
  const CutCells& cc = *mesh.cut_cells;
  using Real = Vector<double>;  // a cell per lane
  constexpr int lanes = Lanes<double>::count;
  constexpr QuarticMoments nothing{};
  Real sum[num_quartics] = {}, moments[num_quartics], shift[3] = {};
  const double* from[lanes];
  PaddedPolynomial right = PaddedPolynomial::Zero();
  for (int begin = 0; begin < num_cells; begin += lanes) {
    for (int l = 0; l < lanes; ++l) {
      from[l] = nothing.data();
      if (begin + l >= num_cells) continue;
      const Index3& cell = cc.cells[cells[begin + l]];
      const int row = integrals.cells.row(cells[begin + l]);
      const double d[3] = {cell[0] + 0.5 - centre[0], cell[1] + 0.5 - centre[1], cell[2] + 0.5 - centre[2]};
      for (int k = 0; k < 3; ++k) set_lane(shift[k], l, d[k]);
      from[l] = integrals.moments[integrals.moments_of_row[row]].data();
      const PaddedPolynomial& stress = integrals.stress[row];
      shift_terms(
          d, [&](int t) { return stress.col(t); }, [&](int t, const auto& value) { right.col(t) += value; });
    }
    gather(from, num_quartics, moments);
    shift_moments(shift, moments);
    for (int m = 0; m < num_quartics; ++m) sum[m] += moments[m];
  }
  QuarticMoments whole{};
  for (int m = 0; m < num_quartics; ++m)
    for (int l = 0; l < lanes; ++l) whole[m] += lane(sum[m], l);
  return {quadratic_mass(whole), right.topRows<6>()};
}

}  // namespace cgcontact
