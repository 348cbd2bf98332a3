#include "recovery/edge_moments.hpp"

namespace cgcontact {

EdgeMoments edge_moments(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge,
                         const Vec3& centre, const RealView& u) {
  constexpr int n = 3;
  const CutCells& cc = *mesh.cut_cells;
  EdgeMoments moments;
  moments.with_polynomials.setZero();
  for (int i = 0; i < num_cells; ++i) {
    const int c = cells[i], cut = cc.cut_of_active[c];
    double weights[n * n * n], corner[8][3];
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights);
    if (u.extent(0) > 0)
      for (int a = 0; a < 8; ++a)
        for (int k = 0; k < 3; ++k) corner[a][k] = u(3 * mesh.cell_nodes[c][a] + k);
    for (int q = 0; q < n * n * n; ++q) {
      const double xi[3] = {Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]};
      const Index3& cell = cc.cells[c];
      const Vec3 x(cell[0] + 0.5 * (xi[0] + 1), cell[1] + 0.5 * (xi[1] + 1), cell[2] + 0.5 * (xi[2] + 1));
      double term[6];
      edge.stress(x, term);
      const double weight = weights[q] / 8;
      const double p[num_terms] = {1, x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
      for (int k = 0; k < 6; ++k) {
        for (int t = 0; t < num_terms; ++t) moments.with_polynomials[num_terms * k + t] += weight * p[t] * term[k];
        moments.square += weight * term[k] * term[k];
      }
      if (u.extent(0) == 0) continue;
      double s[6];
      hex_stress(mesh.law, corner, xi, s);
      for (int k = 0; k < 6; ++k) moments.with_stress += weight * term[k] * mesh.stress_factor() * s[k];
    }
  }
  return moments;
}

Eigen::Matrix<double, 6 * num_terms, 1> edge_polynomial(const BodyMesh& mesh, const int* cells, int num_cells,
                                                        const ContactEdge& edge, const PatchFit& fit) {
  EdgeMoments moments = edge_moments(mesh, cells, num_cells, edge, fit.centre, {});
  const Eigen::LLT<Eigen::Matrix<double, num_terms, num_terms>> factor(fit.mass);
  for (int k = 0; k < 6; ++k) {
    auto part = moments.with_polynomials.segment<num_terms>(num_terms * k);
    part = factor.solve(part).eval();
  }
  return moments.with_polynomials;
}

}  // namespace cgcontact
