#include <gtest/gtest.h>

#include <random>

#include "recovery/batched/batched_linear.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact::test_batched_linear {
namespace {

constexpr int n = 40;
constexpr double tolerance = 1e-4;
using Vector40 = Eigen::Matrix<double, n, 1>;
using Matrix40 = Eigen::Matrix<double, n, n>;

struct Problem {
  Matrix40 A;
  Vector40 x, expected;
  int truncated = 0;
};

/// A random matrix with these eigenvalues, the largest of them 1.
Problem make_problem(const Vector40& eigenvalues, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Matrix40 Q =
      Eigen::HouseholderQR<Matrix40>(Matrix40::NullaryExpr([&] { return normal(random); })).householderQ();
  Problem p;
  p.A = Q * eigenvalues.asDiagonal() * Q.transpose();
  p.x = Vector40::NullaryExpr([&] { return normal(random); });
  Vector40 inverse;
  for (int i = 0; i < n; ++i) {
    inverse[i] = eigenvalues[i] > tolerance ? 1 / eigenvalues[i] : 0;
    p.truncated += eigenvalues[i] <= tolerance;
  }
  p.expected = Q * inverse.cwiseProduct(Q.transpose() * p.x);
  return p;
}

/// Spectra with zeros, clusters on both sides of the threshold, also close to it, nothing or all but one truncated.
std::vector<Problem> problems() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-8, 0);
  std::vector<Problem> all;
  for (int kind = 0; kind < 10; ++kind) {
    Vector40 eigenvalues;
    for (int i = 0; i < n; ++i) {
      const double scattered = std::pow(10.0, exponent(random));
      const bool low = i % 4 == 0;
      switch (kind) {
        case 0:
          eigenvalues[i] = scattered;
          break;
        case 1:
          eigenvalues[i] = low ? 0 : 0.1 + scattered / 2;
          break;
        case 2:
          eigenvalues[i] = tolerance * (low ? 0.99 : 1.01 + 1e-6 * i);
          break;
        case 3:
          eigenvalues[i] = tolerance * (low ? 0.99 - 1e-3 * i : 1.5);
          break;
        case 4:
          eigenvalues[i] = 0.01 + scattered / 2;
          break;
        case 5:
          eigenvalues[i] = 0.5 * tolerance * scattered;
          break;
        case 6:
          eigenvalues[i] = low ? 1e-6 : 1;
          break;
        case 7:
          eigenvalues[i] = tolerance * (i == 0 ? 1 - 1e-5 : 1 + 1e-5 * i);
          break;
        case 8:
          eigenvalues[i] = tolerance * (0.9 + 0.2 * (i + 0.5) / n);
          break;
        default:
          eigenvalues[i] = std::pow(10.0, -0.2 * i - 0.1);
      }
    }
    eigenvalues[n - 1] = 1;
    all.push_back(make_problem(eigenvalues, random));
  }
  return all;
}

/// Solves one problem per lane, the first one in lanes that are left.
template <class Real>
void check(const std::vector<Problem>& all, std::size_t first) {
  constexpr int lanes = LaneTraits<Real>::count;
  std::vector<Real> A(packed_row(n)), x(n), scratch(SpectralScratch::size(n));
  const auto of_lane = [&](int l) -> const Problem& { return all[(first + l) % all.size()]; };
  for (int l = 0; l < lanes; ++l)
    for (int i = 0; i < n; ++i) {
      set_lane(x[i], l, of_lane(l).x[i]);
      for (int j = 0; j <= i; ++j) set_lane(A[packed_row(i) + j], l, of_lane(l).A(i, j));
    }
  const SpectralResult<Real> result =
      pseudo_inverse_solve<Real>(A.data(), Real{} + 1.1, tolerance, n, x.data(), scratch.data());
  for (int l = 0; l < lanes; ++l) {
    SCOPED_TRACE((first + l) % all.size());
    EXPECT_TRUE(lane(result.converged, l));
    EXPECT_EQ(lane(result.truncated, l), of_lane(l).truncated);
    double error = 0;
    for (int i = 0; i < n; ++i) error = std::max(error, std::abs(lane(x[i], l) - of_lane(l).expected[i]));
    // Rounding (2e-16) turns eigenvectors by its ratio to the gap to the next eigenvalue. The narrowest gap between
    // kept and truncated is 1e-9 (kind 7: 1e-5 of the threshold of 1e-4): 1e-7, of which little reaches a component;
    // elsewhere the gap is 1e-6 and more.
    const double rounding = (first + l) % all.size() == 7 ? 1e-7 : 1e-9;
    EXPECT_LT(error, rounding * of_lane(l).expected.cwiseAbs().maxCoeff());
  }
}

TEST(BatchedLinear, TruncatedPseudoInverseOfKnownSpectra) {
  const std::vector<Problem> all = problems();
  for (std::size_t first = 0; first < all.size(); ++first) {
    check<double>(all, first);
    check<Vector<double>>(all, first);
  }
}

}  // namespace
}  // namespace cgcontact::test_batched_linear
