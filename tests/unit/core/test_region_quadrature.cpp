// The building blocks of cell integrals: Gauss and triangle rules, root search, regions of a square, compression.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/numbers/root_search.hpp"
#include "core/quadrature/gauss_rules.hpp"
#include "core/quadrature/point_compression.hpp"
#include "core/quadrature/region_quadrature.hpp"

namespace cgcontact::test_region_quadrature {
namespace {

// Proves exactness of the Gauss rules up to degree 2 n - 1; 1e-15 is rounding of a sum of positive terms below 1.
TEST(Rules, GaussIsExact) {
  for (int n = 1; n <= max_gauss_points; ++n)
    for (int degree = 0; degree < 2 * n; ++degree) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += gauss_rule(n).weight[i] * std::pow(gauss_rule(n).node[i], degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-15) << n << " points";
    }
}

// Proves exactness of the triangle rules for all monomials a^i b^j (2 i! j! / (i + j + 2)!), positive weights, points
// inside.
TEST(Rules, TrianglesAreExact) {
  for (int degree = 0; degree <= 16; ++degree) {
    const TriangleRule& rule = triangle_rule(degree);
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) {
        double sum = 0;
        for (std::size_t q = 0; q < rule.weight.size(); ++q)
          sum += rule.weight[q] * std::pow(rule.a[q], i) * std::pow(rule.b[q], j);
        EXPECT_NEAR(sum, 2 * std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3), 1e-15);
      }
    for (std::size_t q = 0; q < rule.weight.size(); ++q) {
      EXPECT_GT(rule.weight[q], 0);
      EXPECT_GT(std::min({rule.a[q], rule.b[q], 1 - rule.a[q] - rule.b[q]}), 0);
    }
  }
}

// Proves that pairs of roots are seen down to a distance where they merge by rounding (f = (x - c)^2 - e).
TEST(Roots, ClosePairsAreFound) {
  for (const double c : {0.02, 0.31, 0.5, 0.97})
    for (int k = 1; k <= 12; ++k) {
      const double e = std::pow(10.0, -2 - k);
      if (c - std::sqrt(e) < 0 || c + std::sqrt(e) > 1) continue;
      auto f = [&](double x) { return FunctionSample{x, (x - c) * (x - c) - e, 2 * (x - c)}; };
      double roots[4];
      ASSERT_EQ(find_roots(f, 0, 1, roots, 4), 2) << c << " " << e;
      EXPECT_NEAR(roots[0], c - std::sqrt(e), 1e-15 / std::sqrt(e));
      EXPECT_NEAR(roots[1], c + std::sqrt(e), 1e-15 / std::sqrt(e));
      auto none = [&](double x) { return FunctionSample{x, (x - c) * (x - c) + e, 2 * (x - c)}; };
      EXPECT_EQ(find_roots(none, 0, 1, roots, 4), 0);
    }
}

// Proves the robust quadratic formula for small leading coefficients and for double roots.
TEST(Roots, Quadratics) {
  double r[2];
  ASSERT_EQ(quadratic_roots(1e-20, 1, -0.25, r), 2);
  EXPECT_DOUBLE_EQ(r[1], 0.25);
  ASSERT_EQ(quadratic_roots(1, -1, 0.25, r), 2);
  EXPECT_DOUBLE_EQ(r[0], 0.5);
  EXPECT_EQ(quadratic_roots(1, 0, 1, r), 0);
  ASSERT_EQ(quadratic_roots(0, 2, -1, r), 1);
  EXPECT_EQ(r[0], 0.5);
  EXPECT_EQ(quadratic_roots(0, 0, 1, r), 0);
}

struct TestRegion {
  std::vector<unsigned char> table;
  Region region;
  TestRegion(const std::vector<Conic>& functions, const std::vector<unsigned char>& values) : table(values) {
    region.predicate.table = &table;
    region.predicate.surface_mask = table.size() - 1;
    for (std::size_t i = 0; i < functions.size(); ++i) {
      RegionFunction f;
      f.bit = std::uint64_t{1} << i;
      f.conic = functions[i];
      region.add(f);
    }
  }
  double area(const RegionRule& rule) const {
    std::vector<RegionPoint> points;
    integrate_region(region, rule, points);
    double sum = 0;
    for (const RegionPoint& p : points) {
      EXPECT_GT(p.weight, 0);
      sum += p.weight;
    }
    return sum;
  }
};

Conic circle(double x, double y, double r) { return {x * x + y * y - r * r, -2 * x, -2 * y, 1, 0, 1}; }

// Proves regions of the unit square bounded by circles, also with tangencies to the square and to each other. 16 points
// per direction resolve analytic integrands to 1e-12.
TEST(Regions, Circles) {
  const RegionRule rule{9, 16, 16};
  EXPECT_NEAR(TestRegion({circle(0, 0, 1)}, {0, 1}).area(rule), pi / 4, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.5, 0.5, 0.5)}, {0, 1}).area(rule), pi / 4, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.4, 0.5, 0.3)}, {0, 1}).area(rule), pi * 0.09, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.4, 0.5, 0.3)}, {1, 0}).area(rule), 1 - pi * 0.09, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.3, 0.5, 1e-3)}, {0, 1}).area(rule), pi * 1e-6, 1e-15);
  const double lens = 2 * 0.09 * std::acos(0.5) - 0.5 * 0.3 * std::sqrt(0.27);  // radius 0.3, distance 0.3
  EXPECT_NEAR(TestRegion({circle(0.35, 0.5, 0.3), circle(0.65, 0.5, 0.3)}, {0, 0, 0, 1}).area(rule), lens, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.5, 0.35, 0.3), circle(0.5, 0.65, 0.3)}, {0, 1, 1, 1}).area(rule),
              2 * pi * 0.09 - lens, 1e-12);
  EXPECT_NEAR(TestRegion({circle(0.3, 0.5, 0.2), circle(0.7, 0.5, 0.2)}, {0, 1, 1, 1}).area(rule), 0.08 * pi, 1e-12);
  // a disc without its segment beyond a diagonal line
  EXPECT_NEAR(TestRegion({circle(0.5, 0.5, 0.3), Conic{-1, 1, 1}}, {0, 0, 0, 1}).area(rule), 0.045 * pi, 1e-12);
}

// Proves two conics without radical line (crossed ellipses; area of the intersection of x^2/a^2 + y^2/b^2 < 1 with its
// copy turned by 90 degrees is 4 a b atan(b / a)).
TEST(Regions, CrossedEllipses) {
  auto ellipse = [](double a, double b) {
    const double p = 1 / (a * a), q = 1 / (b * b);
    return Conic{0.25 * (p + q) - 1, -p, -q, p, 0, q};
  };
  const double a = 0.4, b = 0.25;
  EXPECT_NEAR(TestRegion({ellipse(a, b), ellipse(b, a)}, {0, 0, 0, 1}).area({9, 16, 16}), 4 * a * b * std::atan(b / a),
              1e-11);
}

// Proves that regions of straight lines are exact, also with noise: lines that coincide with sides of the square up to
// rounding give complementary areas.
TEST(Regions, LinesAreExact) {
  EXPECT_DOUBLE_EQ(TestRegion({Conic{-0.5, 1, 1}}, {0, 1}).area({}), 0.125);
  EXPECT_DOUBLE_EQ(TestRegion({Conic{-0.5, 1, 1}, Conic{-0.25, 1, 0}}, {0, 1, 1, 0}).area({}), 0.125 + 0.25 - 0.1875);
  for (const double noise : {0.0, 1e-17, -1e-17, 1e-15}) {
    const Conic line{noise, 3 * noise, -5 * noise};
    EXPECT_NEAR(TestRegion({line}, {0, 1}).area({}) + TestRegion({line}, {1, 0}).area({}), 1, 1e-15);
  }
}

// Proves that few points take over the integrals of many on a curved patch, to rounding, with positive weights; and
// that what few points cannot take leaves them alone.
TEST(Compression, FewPointsTakeTheIntegralsOfMany) {
  std::vector<double> points[3], weights, others;
  const auto add = [&](int n, std::vector<double>& w) {
    for (int i = 0; i < n * n; ++i) {
      const double s = (i % n + 0.5) / n, t = (i / n + 0.5) / n;
      points[0].push_back(s);
      points[1].push_back(t);
      points[2].push_back(0.1 * s * s + 0.05 * t * t * t);
      w.push_back(1.0 / (n * n) * (1 + 0.1 * s));
    }
  };
  add(6, weights);
  add(40, others);
  const FunctionTable table = surface_polynomials(points, 4, false);
  const std::vector<double> before = weights;
  ASSERT_TRUE(take_integrals(table, others, weights));
  for (int f = 0; f < table.num_functions; ++f) {
    double few = 0, many = 0;
    for (std::size_t p = 0; p < weights.size(); ++p) few += weights[p] * table[f][p];
    for (std::size_t p = 0; p < others.size(); ++p) many += others[p] * table[f][weights.size() + p];
    EXPECT_NEAR(few, many, 1e-11);
  }
  for (std::size_t p = 0; p < weights.size(); ++p) EXPECT_GT(weights[p], 0.1 * before[p]);
  for (double& w : others) w = -w;
  const std::vector<double> kept = weights;
  EXPECT_FALSE(take_integrals(table, others, weights));
  EXPECT_EQ(weights, kept);
}

// Proves that compression keeps all integrals, keeps weights positive and needs no more points than functions.
TEST(Compression, KeepsIntegrals) {
  for (const bool curved : {false, true})
    for (int degree = 1; degree <= 5; ++degree) {
      std::vector<double> points[3], weights;
      const int n = 14;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const double s = 0.3 + 0.4 * gauss_rule(n).node[i], t = 0.1 + 0.5 * gauss_rule(n).node[j] * s;
          points[0].push_back(s);
          points[1].push_back(t);
          points[2].push_back(std::sqrt(4 - s * s - t * t));
          weights.push_back(gauss_rule(n).weight[i] * gauss_rule(n).weight[j] * s);
        }
      const std::vector<double> old = weights;
      const FunctionTable table = surface_polynomials(points, degree, curved);
      compress_weights(table, weights);
      int kept = 0;
      for (double w : weights) {
        EXPECT_GE(w, 0);
        kept += w > 0;
      }
      EXPECT_LE(kept, table.num_functions);
      for (int f = 0; f < table.num_functions; ++f) {
        double before = 0, after = 0;
        for (std::size_t p = 0; p < weights.size(); ++p) {
          before += old[p] * table[f][p];
          after += weights[p] * table[f][p];
        }
        EXPECT_NEAR(after, before, 1e-12);
      }
    }
}

}  // namespace
}  // namespace cgcontact::test_region_quadrature
