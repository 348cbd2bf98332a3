/// The interior rows of the stress polynomials against stresses of polynomial displacements.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <map>
#include <random>

#include "recovery/patch/polynomials.hpp"

namespace cgcontact::test_polynomials {
namespace {

using Exponents = std::array<int, 3>;
using Poly = std::map<Exponents, double>;

Poly derivative(const Poly& p, int i) {
  Poly d;
  for (const auto& [e, value] : p) {
    if (e[i] == 0) continue;
    Exponents lower = e;
    --lower[i];
    d[lower] += e[i] * value;
  }
  return d;
}

void add(Poly& to, double factor, const Poly& p) {
  for (const auto& [e, value] : p) to[e] += factor * value;
}

double coefficient(const Poly& p, const Exponents& e) {
  const auto found = p.find(e);
  return found == p.end() ? 0 : found->second;
}

/// Displacement -> stress (E = 1), 6 components.
std::array<Poly, 6> stress_of(const std::array<Poly, 3>& u, double nu) {
  const double mu = 1 / (2 * (1 + nu)), lambda = nu / ((1 + nu) * (1 - 2 * nu));
  Poly trace;
  for (int i = 0; i < 3; ++i) add(trace, 1, derivative(u[i], i));
  std::array<Poly, 6> s;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      Poly& p = s[component_of(i, j)];
      add(p, mu, derivative(u[i], j));
      add(p, mu, derivative(u[j], i));
      if (i == j) add(p, lambda, trace);
    }
  return s;
}

std::array<Poly, 3> divergence_of(const std::array<Poly, 6>& s) {
  std::array<Poly, 3> f;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) add(f[i], 1, derivative(s[component_of(i, j)], j));
  return f;
}

/// Term t of {1, x, y, z, xx, yy, zz, xy, yz, zx}.
constexpr Exponents term[10] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};

template <int degree>
Eigen::VectorXd interior_of(const std::array<Poly, 6>& s, double nu) {
  Eigen::VectorXd rows(Polynomial<degree>::num_interior);
  Polynomial<degree>::interior([&](int c, int t) { return coefficient(s[c], term[t]); }, 1 / (1 + nu), rows.data());
  return rows;
}

std::vector<Exponents> exponents_up_to(int degree) {
  std::vector<Exponents> all;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k) all.push_back({i, j, k});
  return all;
}

std::array<Poly, 3> displacement(const std::vector<Exponents>& terms, const Eigen::VectorXd& values) {
  std::array<Poly, 3> u;
  for (std::size_t t = 0; t < terms.size(); ++t)
    for (int i = 0; i < 3; ++i) u[i][terms[t]] = values[3 * t + i];
  return u;
}

Eigen::VectorXd random_values(Eigen::Index n) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(n);
  for (double& x : v) x = normal(generator);
  return v;
}

/// Any displacement: its stresses are compatible, and in equilibrium with the force -div sigma.
template <int degree>
void check_with_body_force(double nu) {
  const auto terms = exponents_up_to(degree + 1);
  const auto s = stress_of(displacement(terms, random_values(3 * terms.size())), nu);
  const auto divergence = divergence_of(s);
  double f[3], df[3][3], values[Polynomial<degree>::num_interior], size = 0;
  for (int i = 0; i < 3; ++i) {
    f[i] = -coefficient(divergence[i], term[0]);
    for (int k = 0; k < 3; ++k) df[i][k] = -coefficient(divergence[i], term[1 + k]);
  }
  Polynomial<degree>::interior_values(f, df, nu, values);
  const Eigen::VectorXd rows = interior_of<degree>(s, nu);
  for (const Poly& p : s)
    for (const auto& entry : p) size = std::max(size, std::abs(entry.second));
  // 1 / (1 - 2 nu) is in `size`; some ten terms of that size cancel.
  for (int r = 0; r < rows.size(); ++r) EXPECT_NEAR(rows[r], values[r], 1e-14 * size) << "row " << r << ", nu " << nu;
}

TEST(Polynomials, InteriorRowsWithBodyForce) {
  for (const double nu : {0.0, 0.2, 0.3, 0.45, 0.4999}) {
    check_with_body_force<1>(nu);
    check_with_body_force<2>(nu);
  }
}

/// Cubic solutions of Navier's equation: all rows vanish.
TEST(Polynomials, InteriorRowsVanishForNaviersSolutions) {
  const auto terms = exponents_up_to(3);
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(terms.size());
  for (const double nu : {0.0, 0.2, 0.3, 0.45, 0.4999}) {
    Eigen::MatrixXd force(12, n);  // coefficients of 1, x, y, z, per unknown of the displacement
    for (Eigen::Index c = 0; c < n; ++c) {
      const auto f = divergence_of(stress_of(displacement(terms, Eigen::VectorXd::Unit(n, c)), nu));
      for (int i = 0; i < 3; ++i)
        for (int t = 0; t < 4; ++t) force(4 * i + t, c) = coefficient(f[i], term[t]);
    }
    const Eigen::MatrixXd solutions = Eigen::FullPivLU<Eigen::MatrixXd>(force).kernel();
    ASSERT_EQ(solutions.cols(), 48);
    const Eigen::VectorXd u = solutions * random_values(solutions.cols());
    const auto s = stress_of(displacement(terms, u), nu);
    EXPECT_LT(interior_of<2>(s, nu).lpNorm<Eigen::Infinity>(), 1e-13 * u.norm() / (1 - 2 * nu)) << nu;
  }
}

/// visit_row() gives the entries of the rows that interior() multiplies with.
TEST(Polynomials, RowsByEntries) {
  const double g = 0.7;
  for (int c = 0; c < 6; ++c)
    for (int t = 0; t < 10; ++t) {
      double product[18];
      Polynomial<2>::interior([&](int i, int j) { return i == c && j == t ? 1.0 : 0.0; }, g, product);
      for (int r = 0; r < 18; ++r) {
        double sum = 0;
        Polynomial<2>::visit_row(r, g, [&](int i, int j, double entry) { sum += i == c && j == t ? entry : 0; });
        EXPECT_EQ(sum, product[r]);
      }
    }
}

}  // namespace
}  // namespace cgcontact::test_polynomials
