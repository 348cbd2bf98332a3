#include "kernels/operator/element_matrices.hpp"

#include <algorithm>

#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// K = factor sum_q w_q B_q^T D B_q over the Gauss points, and of trilinear elements the share of the mean dilatation.
template <int degree, class Matrix>
void integrate_stiffness(const UnitElasticity& law, const double* weights, double factor, const Matrix& matrix) {
  using Element = HexElement<degree>;
  using Gauss = typename Element::Gauss;
  constexpr int nodes = Element::num_nodes, n = Gauss::count;
  double K[Element::num_dofs][Element::num_dofs] = {}, dilatation[Element::num_dofs] = {}, volume = 0;
  const double lambda = degree == 1 ? law.lambda_at_points() : law.lambda;
  for (int q = 0; q < n * n * n; ++q) {
    const double xi[3] = {Gauss::point[q / (n * n)], Gauss::point[q / n % n], Gauss::point[q % n]};
    double dN[nodes][3];
    Element::gradient(xi, dN);
    const double w = weights[q] / 8;  // cell coordinates -> cell units
    volume += w;
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) dilatation[dof_of(a, i)] += w * dN[a][i];
    for (int a = 0; a < nodes; ++a)
      for (int b = 0; b < nodes; ++b)
        for (int i = 0; i < 3; ++i) {
          const double *ga = dN[a], *gb = dN[b];
          for (int j = 0; j < 3; ++j)
            K[dof_of(a, i)][dof_of(b, j)] += w * (lambda * ga[i] * gb[j] + law.mu * ga[j] * gb[i]);
          K[dof_of(a, i)][dof_of(b, i)] += w * law.mu * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
        }
  }
  const double of_mean = law.lambda - lambda;
  for (int r = 0; r < Element::num_dofs; ++r)
    for (int c = 0; c < Element::num_dofs; ++c)
      matrix(r, c) =
          factor * (0.5 * (K[r][c] + K[c][r]) + (of_mean > 0 ? of_mean * dilatation[r] * dilatation[c] / volume : 0));
}

/// The same for a cell of a body of revolution: strain u_r / r across, volume in proportion to the radius. The five
/// points integrate all of it exactly but for the product of two displacements extrapolated to the axis over r
/// (docs/theory.md, "Bodies of revolution").
template <int degree, class Matrix>
void integrate_ring(const BodyMesh& mesh, int cell, const double* weights, double factor, const Matrix& matrix) {
  using Element = HexElement<degree>;
  constexpr int nodes = Element::num_nodes, n = Gauss5::count;
  const Grid& grid = mesh.cut_cells->grid;
  const Ring ring = mesh.ring_of(cell);
  UnitElasticity at_points = mesh.law;
  at_points.lambda = degree == 1 ? mesh.law.lambda_at_points() : mesh.law.lambda;
  at_points.lambda_of_mean = 0;
  double K[Element::num_dofs][Element::num_dofs] = {}, dilatation[Element::num_dofs] = {}, volume = 0;
  for (int q = 0; q < n * n * n; ++q) {
    const double xi[3] = {Gauss5::point[q / (n * n)], Gauss5::point[q / n % n], Gauss5::point[q % n]};
    double N[nodes], dN[nodes][3];
    Element::shape(xi, N);
    Element::gradient(xi, dN);
    const double diameter = ring.diameter + xi[ring.radial];
    const double w = weights[q] / 8 * diameter * 0.5 * mesh.cut_cells->h(cell) / grid.unit_radius;
    double gradient[Element::num_dofs][3][3] = {}, stress[Element::num_dofs][6];
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        double(&g)[3][3] = gradient[dof_of(a, i)];
        for (int j = 0; j < 3; ++j) g[i][j] = dN[a][j];
        if (i == ring.radial) g[ring.across][ring.across] = 2 * N[a] / diameter;
        at_points.stress(g, 0, stress[dof_of(a, i)]);
        dilatation[dof_of(a, i)] += w * (g[0][0] + g[1][1] + g[2][2]);
      }
    volume += w;
    for (int r = 0; r < Element::num_dofs; ++r)
      for (int c = 0; c < Element::num_dofs; ++c)
        for (int i = 0; i < 3; ++i) {
          const int j = (i + 1) % 3;
          K[r][c] +=
              w * (gradient[r][i][i] * stress[c][i] + (gradient[r][i][j] + gradient[r][j][i]) * stress[c][3 + i]);
        }
  }
  const double of_mean = mesh.law.lambda - at_points.lambda;
  for (int r = 0; r < Element::num_dofs; ++r)
    for (int c = 0; c < Element::num_dofs; ++c)
      matrix(r, c) =
          factor * (0.5 * (K[r][c] + K[c][r]) + (of_mean > 0 ? of_mean * dilatation[r] * dilatation[c] / volume : 0));
}

}  // namespace

template <int degree>
CellMatrixViewOf<degree> make_cell_matrices(const BodyMesh& mesh, const std::vector<SupportTerm>& supports) {
  using Element = HexElement<degree>;
  constexpr int n = Element::Gauss::count;
  const CutCells& cc = *mesh.cut_cells;
  const std::size_t num_cut = cc.moments.size();
  CellMatrixViewOf<degree> matrices("cgcontact::element_matrices::cells", 1 + num_cut);
  auto host = Kokkos::create_mirror_view(matrices);
  parallel_for("cgcontact::element_matrices::cells", 1 + num_cut, grain_of_heavy, [&](std::size_t m) {
    double weights[Gauss5::count * Gauss5::count * Gauss5::count];
    if (mesh.is_axisymmetric()) {
      if (m == 0) return;  // each cell has a matrix of its own
      const int cell = cc.active_of_cut[m - 1];
      fitted_weights(cc.moments[m - 1], Gauss5::count, weights);
      return integrate_ring<degree>(mesh, cell, weights, mesh.modulus * mesh.thickness_of_level(cc.level(cell)),
                                    Kokkos::subview(host, m, Kokkos::ALL, Kokkos::ALL));
    }
    fitted_weights(m == 0 ? full_cell_moments() : cc.moments[m - 1], n, weights);
    const double factor = mesh.modulus * mesh.thickness_of_level(m == 0 ? 0 : cc.level(cc.active_of_cut[m - 1]));
    integrate_stiffness<degree>(mesh.law, weights, factor, Kokkos::subview(host, m, Kokkos::ALL, Kokkos::ALL));
  });
  for (const SupportTerm& t : supports) {
    const int cut = cc.cut_of_active[t.cell];
    double N[Element::num_nodes], row[Element::num_dofs];
    Element::shape(t.xi.data(), N);
    for (int a = 0; a < Element::num_nodes; ++a)
      for (int i = 0; i < 3; ++i) row[dof_of(a, i)] = N[a] * t.direction[i];
    for (int r = 0; r < Element::num_dofs; ++r)
      for (int c = 0; c < Element::num_dofs; ++c) host(1 + cut, r, c) += t.stiffness * (row[r] * row[c]);
  }
  Kokkos::deep_copy(matrices, host);
  return matrices;
}

template <int degree>
GhostMatrixOf<degree> make_ghost_matrix(const BodyMesh& mesh, double gamma) {
  using Face = GhostFace<degree>;
  using Line = LineElement<degree>;
  constexpr int n = HexElement<degree>::nodes_per_line, per_layer = HexElement<degree>::nodes_per_face;
  const double factor =
      gamma * (2 * mesh.law.mu + mesh.law.lambda_at_points()) * mesh.modulus * mesh.thickness_of_level(0);
  GhostMatrixOf<degree> g{};
  for (int order = 1; order <= degree; ++order) {
    const double share = order == 1 ? factor : factor / 4;  // l!^2
    for (int r = 0; r < Face::num_nodes; ++r)
      for (int c = 0; c < Face::num_nodes; ++c)
        g[r][c] += share * Face::jump(order, r / per_layer) * Face::jump(order, c / per_layer) *
                   Line::mass(r % n, c % n) * Line::mass(r % per_layer / n, c % per_layer / n);
  }
  return g;
}

template CellMatrixViewOf<1> make_cell_matrices<1>(const BodyMesh&, const std::vector<SupportTerm>&);
template CellMatrixViewOf<2> make_cell_matrices<2>(const BodyMesh&, const std::vector<SupportTerm>&);
template GhostMatrixOf<1> make_ghost_matrix<1>(const BodyMesh&, double);
template GhostMatrixOf<2> make_ghost_matrix<2>(const BodyMesh&, double);

}  // namespace cgcontact
