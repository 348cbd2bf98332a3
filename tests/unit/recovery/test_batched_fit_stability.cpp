/// 10,000 random patches, among them slivers, thin walls, edges, corners, doubled rows, contact between bodies of very
/// different stiffness and cell size, conflicting data: what the batched fit promises for every one of them.
///
/// Notation: patch norm |x|^2 = x . M x; rows C of unit length in that norm; sigma: their singular values, the largest
/// at least 1; tau: the relative tolerance. With P the projector onto the singular vectors that are kept,
///   a - a0 = P pseudo-inverse(defect of a0), hence |a - a0| <= |defect| / (tau sigma_max);
///   for any field x, whose rows miss the data by delta:  a - x = (1 - P)(a0 - x) + pseudo-inverse(delta), hence
///   |a - x| <= |a0 - x| + |delta| / (tau sigma_max):
/// if the data belong to the exact field, the constrained fit is never farther from it than the unconstrained one.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/fit_patches.hpp"

namespace cgcontact::test_batched_fit_stability {
namespace {

constexpr double tau = 0.05;

test::Shape random_shape(test::Generator& g) {
  test::Shape shape;
  shape.faces = g.integer(0, 3);
  shape.opposite = g.integer(0, 3) == 0;
  shape.redundant = g.integer(0, 3) == 0;
  shape.slivers = g.integer(0, 1) == 0;
  shape.min_fraction = std::pow(10, -g.integer(0, 12));
  shape.cell_ratio = std::pow(8, g.uniform(-1, 1));
  shape.data_ratio = std::pow(10, g.uniform(-6, 6));
  const double ratios[4] = {0, 0.3, 0.49, 0.4999};
  shape.poisson_ratio = ratios[g.integer(0, 3)];
  return shape;
}

/// Smallest eigenvalue of the mass matrices with unit diagonal: a pivot of Cholesky is at least that fraction
/// of its entry.
double min_scaled_eigenvalue(const Eigen::MatrixXd& M) {
  const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * M * scale.asDiagonal(),
                                                        Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

struct Tally {
  int flagged = 0, truncated = 0, conflicting = 0;
  double worst_unmet = 0, worst_report = 0;
};

template <int degree, int bodies>
void check_patch(const test::FitProblem<degree, bodies>& problem, const test::DenseFit& dense,
                 const Eigen::VectorXd& exact, const FitInput<degree, bodies>& fitted, const FitStatus& status,
                 Tally& tally) {
  const Eigen::VectorXd a = test::coefficients(fitted);
  if (!status.finite) {
    ++tally.flagged;
    EXPECT_EQ((a - test::coefficients(problem.input)).norm(), 0);
    EXPECT_LT(min_scaled_eigenvalue(dense.M), 1e-9);
    return;
  }
  ASSERT_TRUE(a.allFinite());
  const auto rows = dense.whitened();
  const double sigma =
      std::sqrt((rows.C * rows.C.transpose()).selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  const Eigen::VectorXd before = (dense.values - dense.C * dense.a).cwiseQuotient(rows.norm);
  const Eigen::VectorXd delta = (dense.values - dense.C * exact).cwiseQuotient(rows.norm);
  const Eigen::VectorXd after = (dense.values - dense.C * a).cwiseQuotient(rows.norm);
  // Rounding: of the numbers that the correction goes through, relative to what comes out.
  const double level = dense.level(a);
  const double size = 1 + (dense.level(dense.a) + before.norm() / tau) / level;
  const double slack = 1 + 1e-6;
  EXPECT_LT(dense.level(a - dense.a), slack * before.norm() / (tau * sigma) + 1e-12 * level * size);
  EXPECT_LT(dense.level(a - exact),
            slack * (dense.level(dense.a - exact) + delta.norm() / (tau * sigma)) + 1e-12 * level * size);
  const double residual = after.lpNorm<Eigen::Infinity>() / level;
  tally.worst_report = std::max(tally.worst_report, std::abs(residual - status.residual) / size);
  if (status.truncated == 0)
    tally.worst_unmet = std::max(tally.worst_unmet, residual / size);
  else
    ++tally.truncated;
  tally.conflicting += residual > 0.01;
}

template <int degree, int bodies>
Tally check_patches(unsigned seed) {
  constexpr int count = 2500;
  test::Generator g(seed);
  std::vector<test::FitProblem<degree, bodies>> problems;
  std::vector<Eigen::VectorXd> exact;
  std::vector<test::DenseFit> dense;
  for (int i = 0; i < count; ++i) {
    const test::Shape shape = random_shape(g);
    problems.push_back(test::make_problem<degree, bodies>(shape, g));
    auto& p = problems.back();
    dense.emplace_back(p);
    // Data of a field near the unconstrained one, with errors from none to large in two patches of three.
    Eigen::VectorXd x = dense.back().a;
    for (auto& v : x) v += 0.3 * v * g.normal();
    const double error = i % 3 == 0 ? 0 : std::pow(10, g.uniform(-8, 1));
    Eigen::VectorXd values = dense.back().C * x;
    for (auto& v : values) v += error * v * g.normal();
    p.set_values(values);
    dense.back().values = values;
    exact.push_back(x);
  }
  std::vector<FitInput<degree, bodies>> inputs;
  for (const auto& p : problems) inputs.push_back(p.with_rows());
  std::vector<FitStatus> status(count);
  fit_batch(Kokkos::DefaultHostExecutionSpace(), inputs.data(), count, tau, status.data());
  Tally tally;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE("patch " + std::to_string(i));
    check_patch(problems[i], dense[i], exact[i], inputs[i], status[i], tally);
    if (testing::Test::HasFatalFailure()) break;
  }
  return tally;
}

template <int degree, int bodies>
void check_all() {
  const Tally tally = check_patches<degree, bodies>(100 * degree + bodies);
  std::printf("degree %d, %d bodies: %d flagged, %d truncated, %d conflicting; unmet %.1e, report %.1e\n", degree,
              bodies, tally.flagged, tally.truncated, tally.conflicting, tally.worst_unmet, tally.worst_report);
  // Ten digits may be lost in a mass matrix, two in the rows.
  EXPECT_LT(tally.worst_unmet, 1e-13);
  EXPECT_LT(tally.worst_report, 1e-7);
  EXPECT_LT(tally.flagged, 1250);
  EXPECT_GT(tally.truncated, 250);
  EXPECT_GT(tally.conflicting, 50);
}

TEST(BatchedFitStability, Degree1OneBody) { check_all<1, 1>(); }
TEST(BatchedFitStability, Degree1TwoBodies) { check_all<1, 2>(); }
TEST(BatchedFitStability, Degree2OneBody) { check_all<2, 1>(); }
TEST(BatchedFitStability, Degree2TwoBodies) { check_all<2, 2>(); }

}  // namespace
}  // namespace cgcontact::test_batched_fit_stability
