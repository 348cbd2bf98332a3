/// The interior rows eliminated first, against a truncated pseudo-inverse of all rows: patches of two bodies in contact
/// with flat and curved faces, corners, and faces of which the patch holds a small piece.
#include <gtest/gtest.h>

#include "tests/support/fit_patches.hpp"

namespace cgcontact {
namespace {

constexpr double tolerance = 0.025;  // near RecoveryOptions::rank_tolerance_of(2)

struct Case {
  const char* name;
  double curvature = 0;  ///< of the contact face, 1 / cell
  double spread = 1;     ///< of its constraint points
  double weight = 1;     ///< of the second body
  bool corner = false;   ///< the first body has a free side face
  int first_rings = 2, second_rings = 2;
  double tilt = 0;  ///< of both grids, radians
};

constexpr double cut = 0.4;  ///< height of the contact face over the node

/// Mass of the whole cells around the node with the part of them below (side 1) or above (-1) the cut.
void box_mass(int rings, int side, const Eigen::Vector3d& shift, double weight, double* packed) {
  constexpr int T = Polynomial<2>::num_terms;
  std::fill_n(packed, Polynomial<2>::num_packed, 0.0);
  const double gauss[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weights[3] = {5. / 18, 8. / 18, 5. / 18};
  for (int c = 0; c < 8 * rings * rings * rings; ++c) {
    Eigen::Vector3d low(c % (2 * rings) - rings, c / (2 * rings) % (2 * rings) - rings,
                        c / (4 * rings * rings) - rings);
    low += shift;
    Eigen::Vector3d high = low + Eigen::Vector3d::Ones();
    if (side > 0) high[2] = std::min(high[2], cut);
    if (side < 0) low[2] = std::max(low[2], cut);
    if (high[2] <= low[2]) continue;
    for (int q = 0; q < 27; ++q) {
      const int i[3] = {q % 3, q / 3 % 3, q / 9};
      double d[3], p[T], w = weight;
      for (int k = 0; k < 3; ++k) {
        d[k] = 0.5 * (low[k] + high[k]) + 0.5 * (high[k] - low[k]) * gauss[i[k]];
        w *= (high[k] - low[k]) * weights[i[k]];
      }
      Polynomial<2>::terms(d, p);
      for (int s = 0; s < T; ++s)
        for (int t = 0; t <= s; ++t) packed[s * (s + 1) / 2 + t] += w * p[s] * p[t];
    }
  }
}

using Problem = test::FitProblem<2, 2>;

void add_row(Problem& p, const Eigen::Vector3d& x, const Eigen::Vector3d& n, const Eigen::Vector3d& e, double own,
             double other) {
  FitRow<2> row{};
  const double sign[2] = {own, other};
  for (int b = 0; b < 2; ++b) {
    traction_weight(n.data(), e.data(), row.weight[b]);
    for (double& w : row.weight[b]) w *= sign[b];
    for (int i = 0; i < 3; ++i) row.place[b][i] = x[i];
  }
  p.rows.push_back(row);
}

/// The centre and five points around it: they carry the moments of a disk.
std::vector<Eigen::Vector3d> disk(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& u,
                                  const Eigen::Vector3d& v) {
  std::vector<Eigen::Vector3d> points{centre};
  for (int i = 0; i < 5; ++i) {
    const double t = M_PI / 2 + i * 2 * M_PI / 5;
    points.push_back(centre + radius * std::sqrt(2.4) * (std::cos(t) * u + std::sin(t) * v));
  }
  return points;
}

Problem make_case(const Case& c) {
  using Eigen::Vector3d;
  Problem p{};
  box_mass(c.first_rings, 1, Vector3d::Zero(), 1, p.input.mass[0]);
  box_mass(c.second_rings, -1, Vector3d(0.37, -0.21, cut - 0.6), c.weight, p.input.mass[1]);
  test::Generator g(5);
  for (int b = 0; b < 2; ++b) {
    p.input.poisson_ratio[b] = 0.3;
    for (auto& component : p.input.a[b])
      for (double& a : component) a = g.normal();
  }
  const Vector3d ex(std::cos(c.tilt), 0, std::sin(c.tilt)), ey = Vector3d::UnitY();
  for (Vector3d x : disk(Vector3d(0, 0, cut), 0.58 * c.first_rings * c.spread, ex, ey)) {
    Vector3d n = ex.cross(ey) + c.curvature * Vector3d(x[0], x[1], 0);
    n.normalize();
    x[2] -= 0.5 * c.curvature * (x[0] * x[0] + x[1] * x[1]);
    const Vector3d t1 = ey.cross(n).normalized(), t2 = n.cross(t1);
    for (const Vector3d& t : {t1, t2}) {
      add_row(p, x, n, t, 1, 0);
      add_row(p, x, n, t, 0, 1);
    }
    add_row(p, x, n, n, 1, -1);
  }
  if (c.corner)
    for (const Vector3d& x : disk(Vector3d(0.9, 0, cut - 0.8), 0.5, ey, Vector3d::UnitZ()))
      for (int i = 0; i < 3; ++i) add_row(p, x, Vector3d::UnitX(), Vector3d::Unit(i), 1, 0);
  return p;
}

class EliminatedInterior : public testing::TestWithParam<Case> {};

TEST_P(EliminatedInterior, LosesNoRowsAndKeepsEquilibrium) {
  const Problem p = make_case(GetParam());
  const test::DenseFit dense(p);
  ASSERT_EQ(dense.num_held(tolerance), 36);
  FitInput<2, 2> fitted = p.with_rows();
  FitStatus status;
  fit_batch(Kokkos::DefaultHostExecutionSpace(), &fitted, 1, tolerance, &status);
  ASSERT_TRUE(status.finite);
  const Eigen::VectorXd a = test::coefficients(fitted);
  int dropped, dropped_together;
  EXPECT_LT((a - dense.solve_truncated(tolerance, dropped)).norm(), 1e-12 * a.norm());
  EXPECT_EQ(status.truncated, dropped);
  // As many as of all rows together, and where what is dropped says nothing, or nothing is, the same solution.
  const Eigen::VectorXd together = dense.solve_truncated(0, tolerance, dropped_together);
  EXPECT_EQ(status.truncated, dropped_together);
  int redundant;
  dense.solve_truncated(0, 1e-10, redundant);
  if (redundant == dropped_together) {
    EXPECT_LT((a - together).norm(), 1e-12 * a.norm());
  }
  // Of all rows together the truncation leaves equilibrium unmet where it drops rows that say something.
  const auto left = [&](const Eigen::VectorXd& x) {
    const Eigen::VectorXd defect = (dense.values - dense.C * x).cwiseQuotient(dense.whitened().norm);
    return defect.head(dense.num_interior).lpNorm<Eigen::Infinity>() / dense.level(x);
  };
  EXPECT_LT(left(a), 1e-12);
  EXPECT_EQ(left(together) > 1e-8, redundant < dropped_together);
}

INSTANTIATE_TEST_SUITE_P(Patches, EliminatedInterior,
                         testing::Values(Case{"flat"}, Case{"tilted", 0, 1, 1, false, 2, 2, 0.4},
                                         Case{"fewer_rings", 0, 1, 1, false, 1, 2}, Case{"curved_30", 1. / 30},
                                         Case{"curved_5", 1. / 5}, Case{"curved_3", 1. / 3},
                                         Case{"light_second_body", 1. / 5, 1, 1e-3}, Case{"corner", 0, 1, 1, true},
                                         Case{"curved_corner", 1. / 8, 1, 1, true}, Case{"piece_half", 0, 0.5},
                                         Case{"piece_third", 0, 0.3}, Case{"piece_fifth", 0, 0.2},
                                         Case{"piece_tenth", 0, 0.1}, Case{"curved_piece", 1. / 8, 0.2},
                                         Case{"corner_piece", 0, 0.3, 1, true}, Case{"corner_sliver", 0, 0.2, 1, true}),
                         [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace cgcontact
