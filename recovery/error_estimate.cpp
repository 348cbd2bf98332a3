#include "recovery/error_estimate.hpp"

namespace cgcontact {
namespace {

/// s : D^-1 : s for unit Young's modulus; shear entries are tensor components.
double complementary_energy(const double s[6], double nu) {
  const double normal = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
  const double mixed = s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
  const double shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
  return normal - 2 * nu * mixed + 2 * (1 + nu) * shear;
}

void corner_displacements(const BodyMesh& mesh, const RealView& u, int cell, double out[8][3]) {
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) out[a][i] = u(3 * mesh.cell_nodes[cell][a] + i);
}

}  // namespace

EnergySums estimate_error(const BodyMesh& mesh, const Scales& scales, const CoefficientView& recovered,
                          const RealView& u, const ExactStress& exact) {
  const CutCells& cc = *mesh.cut_cells;
  const double nu = mesh.law.lambda / (2 * (mesh.law.lambda + mesh.law.mu));
  const double volume_factor = std::pow(mesh.cell_size, 3) / 8 / mesh.modulus;
  const Mat3& R = cc.grid.rotation;
  EnergySums sums;
  std::vector<double> weights(125);
  for (std::size_t e = 0; e < cc.cells.size(); ++e) {
    const int cut = cc.cut_of_active[e];
    const int n = 5;
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights.data());
    double corner[8][3], cell_error = 0;
    corner_displacements(mesh, u, static_cast<int>(e), corner);
    for (int q = 0; q < n * n * n; ++q) {
      const double xi[3] = {Gauss5::point[q / 25], Gauss5::point[q / 5 % 5], Gauss5::point[q % 5]};
      const double w = weights[q] * volume_factor;
      double s[6], r[6], d[6];
      hex_stress(mesh.law, corner, xi, s);
      evaluate_recovered(mesh, recovered, static_cast<int>(e), xi, r);
      for (int k = 0; k < 6; ++k) {
        s[k] *= mesh.stress_factor();
        d[k] = r[k] - s[k];
      }
      cell_error += w * complementary_energy(d, nu);
      sums.solution += w * complementary_energy(s, nu);
      if (exact) {
        const Index3& c = cc.cells[e];
        const Vec3 x(c[0] + 0.5 * (xi[0] + 1), c[1] + 0.5 * (xi[1] + 1), c[2] + 0.5 * (xi[2] + 1));
        const Sym3 t = voigt(R.transpose() * tensor(exact(cc.grid.to_global(x))) * R) / scales.stress;
        for (int k = 0; k < 6; ++k) d[k] = t[k] - s[k];
        sums.exact_error += w * complementary_energy(d, nu);
        for (int k = 0; k < 6; ++k) d[k] = t[k] - r[k];
        sums.recovered_error += w * complementary_energy(d, nu);
      }
    }
    sums.error_of_cell.push_back(std::max(cell_error, 0.0));
    sums.error += cell_error;
  }
  return sums;
}

}  // namespace cgcontact
