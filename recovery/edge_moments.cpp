#include "recovery/edge_moments.hpp"

namespace cgcontact {
namespace {

/// Full cells farther than that from the edge (cells) take eight points instead of 27: the root is smooth there.
constexpr double smooth_from = 2;

struct Gauss2 {
  static constexpr double point[2] = {-0.57735026918962576, 0.57735026918962576};
  static constexpr double weight[2] = {1, 1};
};

/// Points of a cell; they run along the rows, so that loops over them are vectorised.
template <int n>
struct EdgePoints {
  using Gauss = std::conditional_t<n == 2, Gauss2, Gauss3>;
  static constexpr int size = n * n * n;
  using Row = std::array<double, size>;
  Row weight;
  std::array<Row, 3> position;  ///< grid coordinates

  EdgePoints(const CutCells& cc, int c) {
    const int cut = cc.cut_of_active[c];
    for (int q = 0; q < size; ++q) {
      const int place[3] = {q / (n * n), q / n % n, q % n};
      weight[q] = 1. / 8;
      for (int d = 0; d < 3; ++d) {
        weight[q] *= Gauss::weight[place[d]];
        position[d][q] = cc.cells[c][d] + 0.5 * (Gauss::point[place[d]] + 1);
      }
    }
    if constexpr (n == 3) {
      if (cut < 0) return;
      fitted_weights(cc.moments[cut], n, weight.data());
      for (double& w : weight) w /= 8;
    }
  }
};

/// Components of the term at all points; ContactEdge::stress for a plane face, vectorised.
template <int n>
void set_plane_term(const EdgePoints<n>& points, const ContactEdge& edge,
                    std::array<typename EdgePoints<n>::Row, 6>& term) {
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

template <int n>
void set_term(const EdgePoints<n>& points, const ContactEdge& edge, std::array<typename EdgePoints<n>::Row, 6>& term) {
  for (int q = 0; q < points.size; ++q) {
    double s[6];
    edge.stress(Vec3(points.position[0][q], points.position[1][q], points.position[2][q]), s);
    for (int k = 0; k < 6; ++k) term[k][q] = s[k];
  }
}

/// Adds the integrals over one cell.
template <int degree, int n>
void add_cell(const CutCells& cc, int cell, const Vec3& centre, const ContactEdge& edge,
              double sum[6][Polynomial<degree>::num_terms]) {
  constexpr int T = Polynomial<degree>::num_terms;
  const EdgePoints<n> points(cc, cell);
  std::array<typename EdgePoints<n>::Row, 6> term;
  if (edge.surface.kind == Surface::Kind::plane)
    set_plane_term(points, edge, term);
  else
    set_term(points, edge, term);
  for (int q = 0; q < points.size; ++q) {
    double d[3], p[T];
    for (int k = 0; k < 3; ++k) d[k] = points.position[k][q] - centre[k];
    Polynomial<degree>::terms(d, p);
    for (int k = 0; k < 6; ++k) {
      const double value = points.weight[q] * term[k][q];
      for (int t = 0; t < T; ++t) sum[k][t] += value * p[t];
    }
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
  constexpr int T = Polynomial<degree>::num_terms;
  const CutCells& cc = *mesh.cut_cells;
  double sum[6][T] = {};
  for (int i = 0; i < num_cells; ++i) {
    const Index3& at = cc.cells[cells[i]];
    const double inside = edge.inside(Vec3(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5)) / edge.scale;
    if (cc.cut_of_active[cells[i]] < 0 && std::abs(inside) > smooth_from)
      add_cell<degree, 2>(cc, cells[i], centre, edge, sum);
    else
      add_cell<degree, 3>(cc, cells[i], centre, edge, sum);
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
