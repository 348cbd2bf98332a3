#include "recovery/edge_moments.hpp"

namespace cgcontact {
namespace {

template <int n>
constexpr double gauss_point(int i) {
  return n == 3 ? Gauss3::point[i % 3] : Gauss5::point[i];
}

/// The term at n^3 Gauss points of one cell; the points run along the rows, so that the loops over them are vectorised.
template <int n>
struct CellTerm {
  static constexpr int num_points = n * n * n;
  double position[3][num_points], stress[6][num_points];

  CellTerm(const Index3& cell, const ContactEdge& edge) {
    for (int q = 0; q < num_points; ++q)
      for (int i = 0, stride = n * n; i < 3; ++i, stride /= n)
        position[i][q] = cell[i] + 0.5 * (gauss_point<n>(q / stride % n) + 1);
    if (edge.surface.kind == Surface::Kind::plane && edge.curvature == 0)
      set_plane(edge);
    else
      for (int q = 0; q < num_points; ++q) {
        double s[6];
        edge.stress(Vec3(position[0][q], position[1][q], position[2][q]), s);
        for (int k = 0; k < 6; ++k) stress[k][q] = s[k];
      }
  }

 private:
  /// One frame for all points.
  void set_plane(const ContactEdge& edge) {
    const Vec3 inward = -edge.orientation * edge.surface.direction;
    const Vec3 e = (edge.closed - edge.closed.dot(inward) * inward).normalized(), t = inward.cross(e);
    const double closed[3] = {edge.closed[0], edge.closed[1], edge.closed[2]},
                 in[3] = {inward[0], inward[1], inward[2]};
    const double start = edge.closed.dot(edge.origin), face = inward.dot(edge.surface.point);
    double across[num_points], normal[num_points], shear[num_points];
    for (int q = 0; q < num_points; ++q) {
      const double x = closed[0] * position[0][q] + closed[1] * position[1][q] + closed[2] * position[2][q] - start;
      const double y = in[0] * position[0][q] + in[1] * position[1][q] + in[2] * position[2][q] - face;
      edge_term(edge.scale * x, std::max(edge.scale * y, 0.0), across[q], normal[q], shear[q]);
    }
    constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
    for (int k = 0; k < 6; ++k) {
      const int i = first[k], j = second[k];
      const double third = edge.poisson_ratio * t[i] * t[j], c_across = e[i] * e[j] + third,
                   c_normal = in[i] * in[j] + third, c_shear = e[i] * in[j] + in[i] * e[j];
      for (int q = 0; q < num_points; ++q)
        stress[k][q] = c_across * across[q] + c_normal * normal[q] + c_shear * shear[q];
    }
  }
};

}  // namespace

template <int degree>
EdgeMoments<degree> edge_moments(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge,
                                 const Vec3& centre, const RealView& u) {
  constexpr int n = degree == 1 ? 3 : 5, num_points = n * n * n, T = Polynomial<degree>::num_terms;
  const CutCells& cc = *mesh.cut_cells;
  EdgeMoments<degree> moments;
  moments.with_polynomials.setZero();
  for (int i = 0; i < num_cells; ++i) {
    const int c = cells[i], cut = cc.cut_of_active[c];
    double weights[num_points], terms[T][num_points];
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights);
    const CellTerm<n> term(cc.cells[c], edge);
    for (int q = 0; q < num_points; ++q) {
      const double d[3] = {term.position[0][q] - centre[0], term.position[1][q] - centre[1],
                           term.position[2][q] - centre[2]};
      double p[T];
      Polynomial<degree>::terms(d, p);
      for (int t = 0; t < T; ++t) terms[t][q] = p[t];
    }
    for (int k = 0; k < 6; ++k) {
      double sum[T] = {}, square = 0;
      for (int q = 0; q < num_points; ++q) {
        const double value = weights[q] / 8 * term.stress[k][q];
        for (int t = 0; t < T; ++t) sum[t] += value * terms[t][q];
        square += value * term.stress[k][q];
      }
      for (int t = 0; t < T; ++t) moments.with_polynomials[T * k + t] += sum[t];
      moments.square += square;
    }
    if (u.extent(0) == 0) continue;
    double corner[8][3];
    for (int a = 0; a < 8; ++a)
      for (int k = 0; k < 3; ++k) corner[a][k] = u(3 * mesh.cell_nodes[c][a] + k);
    for (int q = 0; q < num_points; ++q) {
      const double xi[3] = {gauss_point<n>(q / (n * n)), gauss_point<n>(q / n % n), gauss_point<n>(q % n)};
      double s[6];
      hex_stress(mesh.law, corner, xi, s);
      for (int k = 0; k < 6; ++k)
        moments.with_stress += weights[q] / 8 * mesh.stress_factor() * s[k] * term.stress[k][q];
    }
  }
  return moments;
}

template EdgeMoments<1> edge_moments<1>(const BodyMesh&, const int*, int, const ContactEdge&, const Vec3&,
                                        const RealView&);
template EdgeMoments<2> edge_moments<2>(const BodyMesh&, const int*, int, const ContactEdge&, const Vec3&,
                                        const RealView&);

namespace {

template <int degree>
void subtract(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
              PatchFit& fit) {
  constexpr int T = Polynomial<degree>::num_terms;
  const EdgeMoments<degree> moments = edge_moments<degree>(mesh, cells, num_cells, edge, fit.centre, {});
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
