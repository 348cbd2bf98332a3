/// The batched constrained fits against the dense KKT system and the plain fit, patch by patch.
#include <gtest/gtest.h>

#include <algorithm>

#include "recovery/batched/fit_dispatch.hpp"
#include "tests/support/fit_patches.hpp"

namespace cgcontact::test_batched_fit {
namespace {

using test::DenseFit;
using test::FitProblem;

template <class Kind>
class BatchedFit : public testing::Test {};

template <int degree_, int bodies_>
struct Kind {
  static constexpr int degree = degree_, bodies = bodies_;
};
using Kinds = testing::Types<Kind<1, 1>, Kind<1, 2>, Kind<2, 1>, Kind<2, 2>>;
TYPED_TEST_SUITE(BatchedFit, Kinds);

constexpr double tolerance = 0.05;
const Kokkos::DefaultHostExecutionSpace host;

/// Patches with 0 .. 3 faces and different numbers of rows, whole cells.
template <class K>
std::vector<FitProblem<K::degree, K::bodies>> some_problems(int n, int faces) {
  std::vector<FitProblem<K::degree, K::bodies>> problems;
  for (int i = 0; i < n; ++i) {
    test::Generator generator(17 * i + 3);
    test::Shape shape;
    shape.faces = faces < 0 ? i % 4 : faces;
    problems.push_back(test::make_problem<K::degree, K::bodies>(shape, generator));
  }
  return problems;
}

template <int degree, int bodies>
std::vector<FitInput<degree, bodies>> inputs_of(const std::vector<FitProblem<degree, bodies>>& problems) {
  std::vector<FitInput<degree, bodies>> inputs;
  for (const auto& p : problems) inputs.push_back(p.with_rows());
  return inputs;
}

template <int degree, int bodies>
double difference(const FitInput<degree, bodies>& x, const Eigen::VectorXd& a) {
  return (test::coefficients(x) - a).norm() / a.norm();
}

TYPED_TEST(BatchedFit, EqualsTheDenseKktSolution) {
  const auto problems = some_problems<TypeParam>(61, 1);
  auto inputs = inputs_of(problems);
  std::vector<FitStatus> status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), 1e-3, status.data());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const DenseFit dense(problems[i]);
    EXPECT_TRUE(status[i].finite);
    ASSERT_EQ(status[i].truncated, 0);
    EXPECT_EQ(status[i].rows, dense.C.rows());
    EXPECT_LT(difference(inputs[i], dense.solve_kkt()), 1e-10);
    EXPECT_LT(status[i].residual, 1e-12);
  }
}

/// Edges and corners have exactly redundant rows; data conflict.
TYPED_TEST(BatchedFit, EqualsThePlainFitWhereRowsAreTruncated) {
  const auto problems = some_problems<TypeParam>(90, -1);
  auto inputs = inputs_of(problems);
  std::vector<FitStatus> status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), tolerance, status.data());
  int truncated = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const DenseFit dense(problems[i]);
    int dropped = 0;
    const Eigen::VectorXd a = dense.solve_truncated(tolerance, dropped);
    EXPECT_TRUE(status[i].finite);
    EXPECT_EQ(status[i].truncated, dropped);
    EXPECT_LT(difference(inputs[i], a), 1e-10) << i;
    EXPECT_NEAR(status[i].residual, dense.residual(test::coefficients(inputs[i])), 1e-11);
    truncated += dropped > 0;
  }
  EXPECT_GT(truncated, 20);
}

/// The kernels as a device runs them, a patch for each thread, against the lanes of the host.
TYPED_TEST(BatchedFit, OneLaneGivesWhatEightGive) {
  const auto problems = some_problems<TypeParam>(40, -1);
  auto inputs = inputs_of(problems), single = inputs;
  std::vector<FitStatus> status(inputs.size()), single_status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), tolerance, status.data());
  dispatch_fits<double>(host, single.data(), 40, tolerance, single_status.data());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_EQ(status[i].truncated, single_status[i].truncated);
    EXPECT_LT(difference(single[i], test::coefficients(inputs[i])), 1e-11);
  }
}

/// Bit for bit, whatever the order and the neighbours in the batch.
TYPED_TEST(BatchedFit, APatchDoesNotNoticeItsNeighbours) {
  const auto problems = some_problems<TypeParam>(45, -1);
  const auto inputs = inputs_of(problems);
  auto together = inputs, reversed = inputs, alone = inputs;
  const int n = static_cast<int>(inputs.size());
  std::vector<FitStatus> status(n), other(n);
  fit_batch(host, together.data(), n, tolerance, status.data());
  std::reverse(reversed.begin(), reversed.end());
  reversed[3].mass[0][0] = -1;  // a bad neighbour
  const double nan = std::nan("");
  reversed[5].a[0][2][1] = nan;
  fit_batch(host, reversed.data(), n, tolerance, other.data());
  for (int i = 0; i < n; ++i) fit_batch(host, &alone[i], 1, tolerance, &other[i]);
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd a = test::coefficients(together[i]);
    EXPECT_EQ((test::coefficients(alone[i]) - a).norm(), 0) << i;
    EXPECT_EQ(other[i].residual, status[i].residual);
    const int slot = n - 1 - i;
    if (slot == 3 || slot == 5) continue;
    EXPECT_EQ((test::coefficients(reversed[slot]) - a).norm(), 0) << i;
  }
}

TYPED_TEST(BatchedFit, KeepsAFitThatMeetsTheConstraints) {
  auto problems = some_problems<TypeParam>(30, -1);
  for (auto& p : problems) {
    const DenseFit dense(p);
    p.set_values(dense.C * dense.a);
  }
  auto inputs = inputs_of(problems);
  std::vector<FitStatus> status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), tolerance, status.data());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_LT(difference(inputs[i], test::coefficients(problems[i].input)), 1e-12);
    EXPECT_LT(status[i].residual, 1e-12);
  }
}

/// A disturbed solution goes back to one: not to the old one, but the rows are met.
TYPED_TEST(BatchedFit, ProjectsADisturbedFit) {
  auto problems = some_problems<TypeParam>(30, 1);
  for (auto& p : problems) {
    const DenseFit dense(p);
    p.set_values(dense.C * dense.a);
    p.input.a[0][1][2] += 0.3;
    p.input.a[TypeParam::bodies - 1][3][0] -= 0.2;
  }
  auto inputs = inputs_of(problems);
  std::vector<FitStatus> status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), 1e-3, status.data());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_GT(difference(inputs[i], test::coefficients(problems[i].input)), 1e-3);
    const DenseFit dense(problems[i]);
    EXPECT_LT(dense.residual(test::coefficients(inputs[i])), 1e-12);
  }
}

TYPED_TEST(BatchedFit, FlagsInputItCannotUseAndLeavesItAlone) {
  const auto problems = some_problems<TypeParam>(12, 1);
  auto inputs = inputs_of(problems);
  const double nan = std::nan(""), infinite = 1 / 0.0;
  auto bad_row = problems[6].rows;
  bad_row[2].position[0][1] = nan;
  inputs[0].mass[0][0] = -1;
  inputs[1].mass[0][2] = 0;
  inputs[2].a[0][0][0] = infinite;
  inputs[3].interior[0][1] = nan;
  inputs[6].rows = bad_row.data();
  inputs[7].mass[TypeParam::bodies - 1][1] = nan;
  const auto before = inputs;
  std::vector<FitStatus> status(inputs.size());
  fit_batch(host, inputs.data(), static_cast<int>(inputs.size()), 1e-3, status.data());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const bool bad = i < 4 || i == 6 || i == 7;
    EXPECT_EQ(status[i].finite, !bad) << i;
    if (bad) {
      EXPECT_EQ(std::memcmp(inputs[i].a, before[i].a, sizeof inputs[i].a), 0);
    } else {
      EXPECT_LT(status[i].residual, 1e-12);
    }
  }
}

}  // namespace
}  // namespace cgcontact::test_batched_fit
