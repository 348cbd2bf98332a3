#include "recovery/patch/edge_moments.hpp"

#include "recovery/patch/cells_in_box.hpp"

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
    const double width = cc.size(c);
    for (int q = 0; q < size; ++q) {
      const int index[3] = {q / (n * n), q / n % n, q % n};
      weight[q] = 1. / 8;
      for (int d = 0; d < 3; ++d) {
        weight[q] *= Gauss::weight[index[d]];
        position[d][q] = width * (cc.cells[c][d] + 0.5 * (Gauss::point[index[d]] + 1));
      }
    }
    if constexpr (n == 3) {
      if (cut < 0) return;
      fitted_weights(cc.moments[cut], n, weight.data());
      for (double& w : weight) w /= 8;
    }
  }
};

/// ContactEdge::stress for a plane face, in axes that are the same at all points: across the edge, along it, inwards.
class PlaneTerm {
 public:
  explicit PlaneTerm(const ContactEdge& edge) : edge_(edge) {
    const Vec3 in = -edge.orientation * edge.surface.direction;
    axes_.col(0) = (edge.closed - edge.closed.dot(in) * in).normalized();
    axes_.col(1) = in.cross(axes_.col(0));
    axes_.col(2) = in;
  }

  /// Components at all points of a cell, vectorised.
  template <int n>
  void set(const EdgePoints<n>& points, std::array<typename EdgePoints<n>::Row, 6>& term) const {
    const double start = edge_.closed.dot(edge_.origin), middle = edge_.along.dot(edge_.origin),
                 face = axes_.col(2).dot(edge_.surface.point);
    const double closed = axes_.col(0).dot(edge_.closed),
                 along[2] = {axes_.col(0).dot(edge_.along), axes_.col(1).dot(edge_.along)};
    for (int q = 0; q < points.size; ++q) {
      const double p[3] = {points.position[0][q], points.position[1][q], points.position[2][q]};
      const auto dot = [&](const auto& v) { return v[0] * p[0] + v[1] * p[1] + v[2] * p[2]; };
      const double arc = dot(edge_.along) - middle, turn = edge_.curvature * arc;
      const double x = dot(edge_.closed) - start + 0.5 * turn * arc, y = dot(axes_.col(2)) - face;
      double across, normal, shear;
      edge_term(edge_.scale * x, std::max(edge_.scale * y, 0.0), edge_.inverse_width / edge_.scale, across, normal,
                shear);
      const double third = edge_.poisson_ratio * (across + normal);
      const double e[2] = {closed + turn * along[0], turn * along[1]};  // across the edge there, not of length 1
      const double square = 1 / (e[0] * e[0] + e[1] * e[1]), inverse = std::sqrt(square);
      const double c = e[0] * inverse, s = e[1] * inverse;
      term[0][q] = across * c * c + third * s * s;
      term[1][q] = across * s * s + third * c * c;
      term[2][q] = normal;
      term[3][q] = (across - third) * c * s;
      term[4][q] = shear * s;
      term[5][q] = shear * c;
    }
  }

  /// Turns integrals of the components, in place, to the axes of the grid.
  template <int T>
  void rotate(double sum[6][T]) const {
    for (int t = 0; t < T; ++t) {
      Mat3 s;
      s << sum[0][t], sum[3][t], sum[5][t], sum[3][t], sum[1][t], sum[4][t], sum[5][t], sum[4][t], sum[2][t];
      const Mat3 r = axes_ * s * axes_.transpose();
      for (int k = 0; k < 6; ++k) sum[k][t] = r(voigt_row[k], voigt_column[k]);
    }
  }

 private:
  static constexpr int voigt_row[6] = {0, 1, 2, 0, 1, 2}, voigt_column[6] = {0, 1, 2, 1, 2, 0};
  const ContactEdge& edge_;
  Mat3 axes_;
};

/// The same for any face, in the axes of the grid.
class CurvedTerm {
 public:
  explicit CurvedTerm(const ContactEdge& edge) : edge_(edge) {}

  template <int n>
  void set(const EdgePoints<n>& points, std::array<typename EdgePoints<n>::Row, 6>& term) const {
    for (int q = 0; q < points.size; ++q) {
      double s[6];
      edge_.stress(Vec3(points.position[0][q], points.position[1][q], points.position[2][q]), s);
      for (int k = 0; k < 6; ++k) term[k][q] = s[k];
    }
  }

  template <int T>
  void rotate(double[6][T]) const {}

 private:
  const ContactEdge& edge_;
};

/// Adds the integrals over one cell.
template <int degree, int n, class Term>
void add_cell(const CutCells& cc, int cell, const Vec3& centre, double per_unit, const Term& at,
              double sum[6][Polynomial<degree>::num_terms]) {
  constexpr int T = Polynomial<degree>::num_terms;
  const EdgePoints<n> points(cc, cell);
  std::array<typename EdgePoints<n>::Row, 6> term;
  at.set(points, term);
  for (int q = 0; q < points.size; ++q) {
    double d[3], p[T];
    for (int k = 0; k < 3; ++k) d[k] = per_unit * (points.position[k][q] - centre[k]);
    if (const Grid& grid = cc.grid; grid.is_axisymmetric())
      d[grid.plane_strain] =
          per_unit * (points.position[grid.plane_strain][q] - middle_of_cell(cc, cell)[grid.plane_strain]);
    Polynomial<degree>::terms(d, p);
    for (int k = 0; k < 6; ++k) {
      const double value = points.weight[q] * term[k][q];
      for (int t = 0; t < T; ++t) sum[k][t] += value * p[t];
    }
  }
}

template <int degree, class Term>
Eigen::Matrix<double, 6 * Polynomial<degree>::num_terms, 1> sum_cells(const CutCells& cc, const int* cells,
                                                                      int num_cells, const Vec3& centre,
                                                                      const ContactEdge& edge, double unit) {
  constexpr int T = Polynomial<degree>::num_terms;
  const Term term(edge);
  double sum[6][T] = {};
  for (int i = 0; i < num_cells; ++i) {
    const double inside = edge.inside(middle_of_cell(cc, cells[i])) / edge.scale;
    if (cc.cut_of_active[cells[i]] < 0 && std::abs(inside) > smooth_from * cc.size(cells[i]))
      add_cell<degree, 2>(cc, cells[i], centre, 1 / unit, term, sum);
    else
      add_cell<degree, 3>(cc, cells[i], centre, 1 / unit, term, sum);
  }
  term.rotate(sum);
  return Eigen::Map<const Eigen::Matrix<double, 6 * T, 1>>(sum[0]);
}

}  // namespace

template <int degree>
Eigen::Matrix<double, 6 * Polynomial<degree>::num_terms, 1> edge_moments(const BodyMesh& mesh, const int* cells,
                                                                         int num_cells, const Vec3& centre,
                                                                         const ContactEdge& edge, double unit) {
  return edge.surface.kind == Surface::Kind::plane
             ? sum_cells<degree, PlaneTerm>(*mesh.cut_cells, cells, num_cells, centre, edge, unit)
             : sum_cells<degree, CurvedTerm>(*mesh.cut_cells, cells, num_cells, centre, edge, unit);
}

template Eigen::Matrix<double, 6 * Polynomial<1>::num_terms, 1> edge_moments<1>(const BodyMesh&, const int*, int,
                                                                                const Vec3&, const ContactEdge&,
                                                                                double);
template Eigen::Matrix<double, 6 * Polynomial<2>::num_terms, 1> edge_moments<2>(const BodyMesh&, const int*, int,
                                                                                const Vec3&, const ContactEdge&,
                                                                                double);

template <int degree>
void subtract_edge_term(const BodyMesh& mesh, const int* cells, int num_cells, const Vec3& centre, double unit,
                        const ContactEdge& edge, double factor, const double* mass, double* a) {
  constexpr int T = Polynomial<degree>::num_terms;
  const auto moments = edge_moments<degree>(mesh, cells, num_cells, centre, edge, unit);
  Eigen::Matrix<double, T, T> m;
  for (int i = 0; i < T; ++i)
    for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = *mass++;
  const Eigen::LLT<Eigen::Matrix<double, T, T>> cholesky(m);
  for (int k = 0; k < 6; ++k)
    Eigen::Map<Eigen::Matrix<double, T, 1>>(a + T * k) -= factor * cholesky.solve(moments.template segment<T>(T * k));
}

template void subtract_edge_term<1>(const BodyMesh&, const int*, int, const Vec3&, double, const ContactEdge&, double,
                                    const double*, double*);
template void subtract_edge_term<2>(const BodyMesh&, const int*, int, const Vec3&, double, const ContactEdge&, double,
                                    const double*, double*);

}  // namespace cgcontact
