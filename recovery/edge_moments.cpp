#include "recovery/edge_moments.hpp"

namespace cgcontact {
namespace {

/// Points per direction of a cell, all points; they run along the rows, so that loops over them are vectorised.
struct EdgePoints {
  static constexpr int n = 3, size = n * n * n;
  using Row = std::array<double, size>;
  Row weight;
  std::array<Row, 3> position;  ///< grid coordinates

  static Row weights_of(const Moments& moments) {
    Row weights;
    fitted_weights(moments, n, weights.data());
    for (double& w : weights) w /= 8;
    return weights;
  }

  EdgePoints(const CutCells& cc, int c) {
    static const Row full = weights_of(full_cell_moments());
    const int cut = cc.cut_of_active[c];
    weight = cut < 0 ? full : weights_of(cc.moments[cut]);
    for (int q = 0; q < size; ++q) {
      for (int d = 0, stride = n * n; d < 3; ++d, stride /= n) {
        const int i = q / stride % n;
        position[d][q] = cc.cells[c][d] + 0.5 * (Gauss3::point[i] + 1);
      }
    }
  }
};

/// Components of the term at all points; ContactEdge::stress for a plane face, vectorised.
void set_plane_term(const EdgePoints& points, const ContactEdge& edge, std::array<EdgePoints::Row, 6>& term) {
  const Vec3 in = -edge.orientation * edge.surface.direction;
  const Vec3 closed = edge.closed - edge.closed.dot(in) * in, along = edge.along - edge.along.dot(in) * in;
  const double start = edge.closed.dot(edge.origin), middle = edge.along.dot(edge.origin),
               face = in.dot(edge.surface.point);
  for (int q = 0; q < points.size; ++q) {
    const double p[3] = {points.position[0][q], points.position[1][q], points.position[2][q]};
    const auto dot = [&](const Vec3& v) { return v[0] * p[0] + v[1] * p[1] + v[2] * p[2]; };
    const double arc = dot(edge.along) - middle, turn = edge.curvature * arc;
    const double x = dot(edge.closed) - start + 0.5 * turn * arc, y = dot(in) - face;
    double across, normal, shear;
    edge_term(edge.scale * x, std::max(edge.scale * y, 0.0), edge.inverse_width / edge.scale, across, normal, shear);
    double e[3], length = 0;
    for (int i = 0; i < 3; ++i) {
      e[i] = closed[i] + turn * along[i];
      length += e[i] * e[i];
    }
    length = std::sqrt(length);
    for (int i = 0; i < 3; ++i) e[i] /= length;
    const double t[3] = {in[1] * e[2] - in[2] * e[1], in[2] * e[0] - in[0] * e[2], in[0] * e[1] - in[1] * e[0]};
    const double third = edge.poisson_ratio * (across + normal);
    constexpr int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
    for (int k = 0; k < 6; ++k) {
      const int i = first[k], j = second[k];
      term[k][q] =
          across * e[i] * e[j] + normal * in[i] * in[j] + shear * (e[i] * in[j] + in[i] * e[j]) + third * t[i] * t[j];
    }
  }
}

void set_term(const EdgePoints& points, const ContactEdge& edge, std::array<EdgePoints::Row, 6>& term) {
  for (int q = 0; q < points.size; ++q) {
    double s[6];
    edge.stress(Vec3(points.position[0][q], points.position[1][q], points.position[2][q]), s);
    for (int k = 0; k < 6; ++k) term[k][q] = s[k];
  }
}

template <int degree>
void subtract(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
              PatchFit& fit) {
  constexpr int T = Polynomial<degree>::num_terms;
  const auto moments = edge_moments<degree>(mesh, cells, num_cells, fit.centre, edge);
  const Eigen::LLT<Eigen::Matrix<double, T, T>> cholesky(fit.mass);
  for (int k = 0; k < 6; ++k) fit.a.segment<T>(T * k) -= factor * cholesky.solve(moments.template segment<T>(T * k));
}

}  // namespace

template <int degree>
Eigen::Matrix<double, 6 * Polynomial<degree>::num_terms, 1> edge_moments(const BodyMesh& mesh, const int* cells,
                                                                         int num_cells, const Vec3& centre,
                                                                         const ContactEdge& edge) {
  constexpr int T = Polynomial<degree>::num_terms, N = EdgePoints::size;
  const bool plane = edge.surface.kind == Surface::Kind::plane;
  std::array<EdgePoints::Row, 6> term;
  double sum[6][T] = {};
  for (int i = 0; i < num_cells; ++i) {
    const EdgePoints points(*mesh.cut_cells, cells[i]);
    if (plane)
      set_plane_term(points, edge, term);
    else
      set_term(points, edge, term);
    for (int q = 0; q < N; ++q) {
      double d[3], p[T];
      for (int k = 0; k < 3; ++k) d[k] = points.position[k][q] - centre[k];
      Polynomial<degree>::terms(d, p);
      for (int k = 0; k < 6; ++k) {
        const double value = points.weight[q] * term[k][q];
        for (int t = 0; t < T; ++t) sum[k][t] += value * p[t];
      }
    }
  }
  return Eigen::Map<const Eigen::Matrix<double, 6 * T, 1>>(sum[0]);
}

template Eigen::Matrix<double, 6 * Polynomial<1>::num_terms, 1> edge_moments<1>(const BodyMesh&, const int*, int,
                                                                                const Vec3&, const ContactEdge&);
template Eigen::Matrix<double, 6 * Polynomial<2>::num_terms, 1> edge_moments<2>(const BodyMesh&, const int*, int,
                                                                                const Vec3&, const ContactEdge&);

void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const ContactEdge& edge, double factor,
                        PatchFit& fit) {
  if (fit.degree == 1)
    subtract<1>(mesh, cells, num_cells, edge, factor, fit);
  else
    subtract<2>(mesh, cells, num_cells, edge, factor, fit);
}

}  // namespace cgcontact
