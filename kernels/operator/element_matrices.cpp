#include "kernels/operator/element_matrices.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

/// Cells per chunk of the parallel loops.
constexpr std::size_t grain = 16;

/// K += factor sum_q w_q B_q^T D B_q over the 27 Gauss points.
template <class Matrix>
void integrate_stiffness(const UnitElasticity& law, const double weights[27], double factor, int soft_axis,
                         const Matrix& matrix) {
  double K[24][24] = {};
  for (int q = 0; q < 27; ++q) {
    const double xi[3] = {Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]};
    double dN[8][3];
    hex_gradient(xi, dN);
    double gradient[8][3][3];  // of each component
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) gradient[a][i][k] = dN[a][k];
    for (int i = 0; i < 3 && soft_axis >= 0; ++i) {
      if (i == soft_axis) continue;
      double middle[3] = {xi[0], xi[1], xi[2]};
      middle[i] = 0;
      hex_gradient(middle, dN);
      for (int a = 0; a < 8; ++a) gradient[a][i][soft_axis] = dN[a][soft_axis];
    }
    const double w = weights[q] / 8;  // cell coordinates -> cell units
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        for (int i = 0; i < 3; ++i) {
          const double *ga = gradient[a][i], *gb = gradient[b][i];
          for (int j = 0; j < 3; ++j)
            K[3 * a + i][3 * b + j] +=
                w * (law.lambda * ga[i] * gradient[b][j][j] + law.mu * ga[j] * gradient[b][j][i]);
          K[3 * a + i][3 * b + i] += w * law.mu * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
        }
  }
  for (int r = 0; r < 24; ++r)
    for (int c = 0; c < 24; ++c) matrix(r, c) = factor * 0.5 * (K[r][c] + K[c][r]);
}

}  // namespace

CellMatrixView make_cell_matrices(const BodyMesh& mesh, const std::vector<SupportTerm>& supports,
                                  const std::vector<signed char>& soft_axis) {
  const CutCells& cc = *mesh.cut_cells;
  const std::size_t num_cut = cc.moments.size();
  CellMatrixView matrices("cgcontact::element_matrices::cells", 1 + num_cut);
  auto host = Kokkos::create_mirror_view(matrices);
  const double factor = mesh.modulus * mesh.cell_size;
  parallel_for("cgcontact::element_matrices::cells", 1 + num_cut, grain, [&](std::size_t m) {
    double weights[27];
    fitted_weights(m == 0 ? full_cell_moments() : cc.moments[m - 1], 3, weights);
    const int soft = m == 0 || soft_axis.empty() ? -1 : soft_axis[cc.active_of_cut[m - 1]];
    integrate_stiffness(mesh.law, weights, factor, soft, Kokkos::subview(host, m, Kokkos::ALL, Kokkos::ALL));
  });
  for (const SupportTerm& t : supports) {
    const int cut = cc.cut_of_active[t.cell];
    double N[8], row[24];
    hex_shape(t.xi.data(), N);
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i) row[3 * a + i] = N[a] * t.direction[i];
    for (int r = 0; r < 24; ++r)
      for (int c = 0; c < 24; ++c) host(1 + cut, r, c) += t.stiffness * (row[r] * row[c]);
  }
  Kokkos::deep_copy(matrices, host);
  return matrices;
}

GhostMatrix make_ghost_matrix(const BodyMesh& mesh, double gamma) {
  const double factor = gamma * (2 * mesh.law.mu + mesh.law.lambda) * mesh.modulus * mesh.cell_size;
  const double jump[3] = {1, -2, 1};  // [d_n u] of the three node layers, constant along n
  const double mass[2][2] = {{1. / 3, 1. / 6}, {1. / 6, 1. / 3}};
  GhostMatrix g;
  for (int r = 0; r < 12; ++r)
    for (int c = 0; c < 12; ++c)
      g[r][c] = factor * jump[r / 4] * jump[c / 4] * mass[r & 1][c & 1] * mass[r >> 1 & 1][c >> 1 & 1];
  return g;
}

double ghost_scale(const BodyMesh& mesh, int e, int f) {
  if (!is_ghost_face(mesh, e, f)) return 0;
  if (mesh.full_volume.empty()) return 1;
  const double thickness = std::max(mesh.full_volume[e], mesh.full_volume[f]);
  return thickness * thickness * thickness;
}

}  // namespace cgcontact
