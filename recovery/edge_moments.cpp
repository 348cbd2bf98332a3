#include "recovery/edge_moments.hpp"

namespace cgcontact {

template <int degree>
EdgeQuadrature<degree>::EdgeQuadrature(const BodyMesh& mesh, const int* cells, int num_cells, const Vec3& centre,
                                       const RealView& u)
    : cells_(num_cells), centre_(centre), with_stress_(u.extent(0) > 0) {
  const CutCells& cc = *mesh.cut_cells;
  for (int i = 0; i < num_cells; ++i) {
    Cell& cell = cells_[i];
    const int c = cells[i], cut = cc.cut_of_active[c];
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, cell.weight.data());
    double corner[8][3];
    for (int a = 0; a < 8 && with_stress_; ++a)
      for (int k = 0; k < 3; ++k) corner[a][k] = u(3 * mesh.cell_nodes[c][a] + k);
    for (int q = 0; q < num_points; ++q) {
      cell.weight[q] /= 8;
      double xi[3], s[6];
      for (int d = 0, stride = n * n; d < 3; ++d, stride /= n) {
        xi[d] = n == 3 ? Gauss3::point[q / stride % n % 3] : Gauss5::point[q / stride % n];
        cell.position[d][q] = cc.cells[c][d] + 0.5 * (xi[d] + 1);
      }
      if (!with_stress_) continue;
      hex_stress(mesh.law, corner, xi, s);
      for (int k = 0; k < 6; ++k) cell.stress[k][q] = mesh.stress_factor() * s[k];
    }
  }
}

/// On a plane face along a straight edge all points have the same frame.
template <int degree>
void EdgeQuadrature<degree>::set_plane_term(const Cell& cell, const ContactEdge& edge, std::array<Row, 6>& term) {
  const Vec3 in = -edge.orientation * edge.surface.direction;
  const Vec3 e = (edge.closed - edge.closed.dot(in) * in).normalized(), t = in.cross(e);
  const double start = edge.closed.dot(edge.origin), face = in.dot(edge.surface.point);
  Row across, normal, shear;
  for (int q = 0; q < num_points; ++q) {
    const double p[3] = {cell.position[0][q], cell.position[1][q], cell.position[2][q]};
    const double x = edge.closed[0] * p[0] + edge.closed[1] * p[1] + edge.closed[2] * p[2] - start;
    const double y = in[0] * p[0] + in[1] * p[1] + in[2] * p[2] - face;
    edge_term(edge.scale * x, std::max(edge.scale * y, 0.0), edge.inverse_width / edge.scale, across[q], normal[q],
              shear[q]);
  }
  constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
  for (int k = 0; k < 6; ++k) {
    const int i = first[k], j = second[k];
    const double third = edge.poisson_ratio * t[i] * t[j], c_across = e[i] * e[j] + third,
                 c_normal = in[i] * in[j] + third, c_shear = e[i] * in[j] + in[i] * e[j];
    for (int q = 0; q < num_points; ++q) term[k][q] = c_across * across[q] + c_normal * normal[q] + c_shear * shear[q];
  }
}

template <int degree>
EdgeMoments<degree> EdgeQuadrature<degree>::moments(const ContactEdge& edge) const {
  constexpr int T = Polynomial<degree>::num_terms;
  EdgeMoments<degree> moments;
  moments.with_polynomials.setZero();
  const bool plane = edge.surface.kind == Surface::Kind::plane && edge.curvature == 0;
  std::array<Row, 6> term;
  for (const Cell& cell : cells_) {
    if (plane) {
      set_plane_term(cell, edge, term);
    } else {
      for (int q = 0; q < num_points; ++q) {
        double s[6];
        edge.stress(Vec3(cell.position[0][q], cell.position[1][q], cell.position[2][q]), s);
        for (int k = 0; k < 6; ++k) term[k][q] = s[k];
      }
    }
    double terms[T][num_points];
    for (int q = 0; q < num_points; ++q) {
      const double d[3] = {cell.position[0][q] - centre_[0], cell.position[1][q] - centre_[1],
                           cell.position[2][q] - centre_[2]};
      double p[T];
      Polynomial<degree>::terms(d, p);
      for (int t = 0; t < T; ++t) terms[t][q] = p[t];
    }
    for (int k = 0; k < 6; ++k) {
      double sum[T] = {}, square = 0, with_stress = 0;
      for (int q = 0; q < num_points; ++q) {
        const double value = cell.weight[q] * term[k][q];
        for (int t = 0; t < T; ++t) sum[t] += value * terms[t][q];
        square += value * term[k][q];
      }
      for (int t = 0; t < T; ++t) moments.with_polynomials[T * k + t] += sum[t];
      moments.square += square;
      if (!with_stress_) continue;
      for (int q = 0; q < num_points; ++q) with_stress += cell.weight[q] * term[k][q] * cell.stress[k][q];
      moments.with_stress += with_stress;
    }
  }
  return moments;
}

template class EdgeQuadrature<1>;
template class EdgeQuadrature<2>;

namespace {

template <int degree>
void subtract(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
              PatchFit& fit) {
  constexpr int T = Polynomial<degree>::num_terms;
  const EdgeMoments<degree> moments = EdgeQuadrature<degree>(mesh, cells, num_cells, fit.centre, {}).moments(edge);
  const Eigen::LLT<Eigen::Matrix<double, T, T>> cholesky(fit.mass);
  for (int k = 0; k < 6; ++k)
    fit.a.segment<T>(T * k) -= factor * cholesky.solve(moments.with_polynomials.template segment<T>(T * k));
}

}  // namespace

void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
                        PatchFit& fit) {
  if (fit.degree == 1)
    subtract<1>(mesh, cells, num_cells, edge, factor, fit);
  else
    subtract<2>(mesh, cells, num_cells, edge, factor, fit);
}

}  // namespace cgcontact
