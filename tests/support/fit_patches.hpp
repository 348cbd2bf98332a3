/// Random constrained fits with everything that makes them difficult, and their dense plain solution.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "recovery/batched/batched_fit.hpp"

namespace cgcontact::test {

struct Generator {
  std::mt19937 engine;
  explicit Generator(unsigned seed) : engine(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  double normal() { return std::normal_distribution<double>()(engine); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine); }
  Eigen::Vector3d direction() { return Eigen::Vector3d(normal(), normal(), normal()).normalized(); }
};

/// What a random patch may look like; the defaults are well-behaved.
struct Shape {
  int faces = 1;            ///< their normals are orthogonal: face, edge, corner
  bool opposite = false;    ///< the second face is opposite to the first: a thin wall
  bool redundant = false;   ///< some rows twice
  bool slivers = false;     ///< bare slivers among the patches
  double min_fraction = 1;  ///< cut fractions down to this, logarithmically
  double cell_ratio = 1;    ///< cell size of the first body over that of the second
  double data_ratio = 1;    ///< stress level of the second body over that of the first
  double poisson_ratio = 0.3;
};

template <int degree, int bodies>
struct FitProblem {
  FitInput<degree, bodies> input;
  std::vector<FitRow<bodies>> rows;

  FitInput<degree, bodies> with_rows() const {
    FitInput<degree, bodies> in = input;
    in.rows = rows.data();
    in.num_rows = static_cast<int>(rows.size());
    return in;
  }
  /// Right-hand sides of all rows, interior ones first.
  void set_values(const Eigen::VectorXd& values) {
    constexpr int ni = Polynomial<degree>::num_interior;
    for (int b = 0; b < bodies; ++b)
      for (int i = 0; i < ni; ++i) input.interior[b][i] = values[b * ni + i];
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r].value = values[bodies * ni + r];
  }
};

template <int degree, int bodies>
Eigen::VectorXd coefficients(const FitInput<degree, bodies>& in) {
  return Eigen::Map<const Eigen::VectorXd>(&in.a[0][0][0], bodies * 6 * Polynomial<degree>::num_terms);
}

/// Rows and masses as dense matrices, straight from the definitions: derivatives of the terms, one after the other.
struct DenseFit {
  Eigen::MatrixXd C, M;
  Eigen::VectorXd values, a;

  template <int degree, int bodies>
  explicit DenseFit(const FitProblem<degree, bodies>& p) {
    constexpr int T = Polynomial<degree>::num_terms, ni = Polynomial<degree>::num_interior;
    const int num_rows = bodies * ni + static_cast<int>(p.rows.size());
    C = Eigen::MatrixXd::Zero(num_rows, bodies * 6 * T);
    M = Eigen::MatrixXd::Zero(C.cols(), C.cols());
    values = Eigen::VectorXd::Zero(num_rows);
    a = coefficients(p.input);
    for (int b = 0; b < bodies; ++b) {
      C.block(b * ni, b * 6 * T, ni, 6 * T) = interior_rows(degree, p.input.poisson_ratio[b]);
      for (int i = 0; i < ni; ++i) values[b * ni + i] = p.input.interior[b][i];
      for (int c = 0; c < 6; ++c)
        for (int i = 0; i < T; ++i)
          for (int j = 0; j <= i; ++j) {
            const int at = (b * 6 + c) * T;
            M(at + i, at + j) = M(at + j, at + i) = p.input.mass[b][i * (i + 1) / 2 + j];
          }
    }
    for (std::size_t r = 0; r < p.rows.size(); ++r) {
      for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
          for (int t = 0; t < T; ++t)
            C(bodies * ni + r, (b * 6 + c) * T + t) =
                p.rows[r].weight[b][c] * term(t, Eigen::Map<const Eigen::Vector3d>(p.rows[r].position[b]));
      values[bodies * ni + r] = p.rows[r].value;
    }
  }

  /// Rows of unit length in the patch norm, in terms of y = L^T a.
  struct Whitened {
    Eigen::MatrixXd C;
    Eigen::VectorXd norm;
    Eigen::LLT<Eigen::MatrixXd> factor;
  };
  Whitened whitened() const;
  static double term(int t, const Eigen::Vector3d& x);
  static Eigen::MatrixXd interior_rows(int degree, double nu);
  Eigen::VectorXd solve_kkt() const;
  /// Truncated singular values of the rows themselves.
  Eigen::VectorXd solve_truncated(double tolerance, int& dropped) const;
  double level(const Eigen::VectorXd& x) const;
  /// As FitStatus::residual, from the dense matrices.
  double residual(const Eigen::VectorXd& x) const;
};

/// Mass of random cells about the centre; a cut cell keeps a slab of the given fraction.
template <int degree>
void random_mass(const Shape& shape, Generator& g, double* packed) {
  constexpr int T = Polynomial<degree>::num_terms;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(T, T);
  const bool bare = shape.slivers && g.integer(0, 3) == 0;
  const double gauss[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  const double weights[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  const int layers = degree == 2 && !shape.slivers ? 3 : 2;  // enough for quadratic polynomials
  for (int cell = 0; cell < layers * layers * layers; ++cell) {
    const bool corner = cell == 0;  // never left out: a patch has a cell
    if (!corner && (bare || (shape.slivers && g.integer(0, 3) == 0))) continue;
    double low[3], size[3] = {1, 1, 1};
    for (int i = 0, c = cell; i < 3; ++i, c /= layers) low[i] = c % layers - 0.5 * layers;
    if (shape.min_fraction < 1 && (bare || (!corner && g.integer(0, 1) == 0)))
      size[g.integer(0, 2)] = std::pow(shape.min_fraction, g.uniform(0, 1));
    for (int q = 0; q < 64; ++q) {
      const int i[3] = {q % 4, q / 4 % 4, q / 16};
      double d[3], p[T], weight = 1;
      for (int k = 0; k < 3; ++k) {
        d[k] = low[k] + size[k] * (0.5 + 0.5 * gauss[i[k]]);
        weight *= 0.5 * size[k] * weights[i[k]];
      }
      Polynomial<degree>::terms(d, p);
      for (int s = 0; s < T; ++s)
        for (int t = 0; t < T; ++t) m(s, t) += weight * p[s] * p[t];
    }
  }
  for (int s = 0; s < T; ++s)
    for (int t = 0; t <= s; ++t) packed[s * (s + 1) / 2 + t] = m(s, t);
}

/// Faces: their first one is a contact face when there are two bodies (zero shear, equal normal stress), else loaded.
template <int degree, int bodies>
FitProblem<degree, bodies> make_problem(const Shape& shape, Generator& g) {
  constexpr int T = Polynomial<degree>::num_terms;
  FitProblem<degree, bodies> p{};
  double data[2] = {1, shape.data_ratio};
  for (int b = 0; b < bodies; ++b) {
    random_mass<degree>(shape, g, p.input.mass[b]);
    for (int c = 0; c < 6; ++c)
      for (int t = 0; t < T; ++t) p.input.a[b][c][t] = data[b] * g.normal();
    for (double& v : p.input.interior[b]) v = data[b] * g.normal();
    p.input.poisson_ratio[b] = shape.poisson_ratio;
  }
  Eigen::Matrix3d frame;
  frame.col(0) = g.direction();
  frame.col(1) = frame.col(0).cross(g.direction()).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  // Three points determine linear, six quadratic tractions.
  const double around[6][2] = {{0, 0.8}, {-0.7, -0.4}, {0.7, -0.4}, {0.05, -0.5}, {0.4, 0.3}, {-0.4, 0.25}};
  for (int f = 0; f < shape.faces; ++f) {
    const bool opposite = shape.opposite && f == 1;
    Eigen::Matrix3d e;
    for (int i = 0; i < 3; ++i) e.col(i) = frame.col((i + (opposite ? 0 : f)) % 3);
    const double at = opposite ? -0.1 : g.uniform(0.1, 0.5);
    if (opposite) e.col(0) = -e.col(0);
    for (int q = 0; q < (degree == 1 ? 3 : 6); ++q) {
      const Eigen::Vector3d d = (opposite ? -at : at) * e.col(0) + around[q][0] * e.col(1) + around[q][1] * e.col(2);
      const bool contact = bodies == 2 && f == 0;
      for (int b = 0; b < (contact ? 2 : 1); ++b)
        for (int k = 0; k < 3; ++k) {
          if (contact && b == 1 && k == 0) continue;  // in the first body's row
          FitRow<bodies> row{};
          traction_weight(e.col(0).data(), e.col(k).data(), row.weight[b]);
          for (int i = 0; i < 3; ++i) row.position[b][i] = d[i] * (b == 1 ? shape.cell_ratio : 1);
          row.value = data[b] * g.normal();
          if (contact && k == 0) {
            traction_weight(e.col(0).data(), e.col(0).data(), row.weight[bodies - 1]);
            for (double& w : row.weight[bodies - 1]) w = -w;
            for (int i = 0; i < 3; ++i) row.position[bodies - 1][i] = d[i] * shape.cell_ratio;
            row.value = 0;
          }
          p.rows.push_back(row);
          if (shape.redundant && g.integer(0, 2) == 0) {
            for (auto& body : row.weight)
              for (double& w : body) w *= 2;
            row.value *= 2;
            p.rows.push_back(row);
          }
        }
    }
  }
  return p;
}

}  // namespace cgcontact::test
