// Winding numbers by clusters against the angles of all triangles, and against what they must be.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/triangles/winding_numbers.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_winding_numbers {
namespace {

/// All triangles, one by one: the angle under which each is seen (Van Oosterom, Strackee 1983).
double plain(const TriangleSoup& soup, const std::vector<WindingNumbers::Passes>& passes, const Vec3& x, int surface) {
  double sum = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    Vec3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = soup.points[soup.triangles[t][k]] - x;
    const double l[3] = {c[0].norm(), c[1].norm(), c[2].norm()};
    sum +=
        passes[t][surface] * std::atan2(c[0].dot(c[1].cross(c[2])), l[0] * l[1] * l[2] + c[0].dot(c[1]) * l[2] +
                                                                        c[1].dot(c[2]) * l[0] + c[2].dot(c[0]) * l[1]);
  }
  return sum / (2 * pi);
}

// Proves the documented error: balls with corners moved at random by up to a third of the radius, so that they cross
// themselves everywhere, with passes -1, 0, 1 and 2; points on all sides and close by.
TEST(WindingNumbers, AreThoseOfAllTriangles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  double worst = 0;
  for (const double noise : {0.0, 0.05, 0.3}) {
    TriangleSoup soup = test::sphere_soup(1, 40);
    for (Vec3& x : soup.points) x += noise * Vec3(any(random), any(random), any(random));
    std::vector<WindingNumbers::Passes> passes;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) passes.push_back({1, static_cast<int>(t % 4) - 1});
    const WindingNumbers numbers(soup.points, soup.triangles, passes);
    for (int i = 0; i < 500; ++i) {
      const Vec3 x = 1.5 * Vec3(any(random), any(random), any(random));
      const auto found = numbers.at(x, -1);
      for (int k = 0; k < 2; ++k) worst = std::max(worst, std::abs(found[k] - plain(soup, passes, x, k)));
      EXPECT_NEAR(found[0], std::round(found[0]), 0.01);  // closed: whole numbers
    }
  }
  EXPECT_LT(worst, 0.02);   // as documented
  EXPECT_GT(worst, 1e-12);  // clusters were used
}

// Proves that the triangle left out is the only one: at its own centroid the mean of both sides is half a turn.
TEST(WindingNumbers, AtATriangle) {
  const TriangleSoup soup = test::sphere_soup(1, 20);
  const std::vector<WindingNumbers::Passes> passes(soup.triangles.size(), {1, 0});
  const WindingNumbers numbers(soup.points, soup.triangles, passes);
  for (int t = 0; t < static_cast<int>(soup.triangles.size()); t += 7) {
    const Triangle& c = soup.triangles[t];
    const Vec3 centroid = (soup.points[c[0]] + soup.points[c[1]] + soup.points[c[2]]) / 3;
    EXPECT_NEAR(numbers.at(centroid, t)[0], 0.5, 0.01);
    EXPECT_EQ(numbers.at(centroid, t)[1], 0);
  }
}

}  // namespace
}  // namespace cgcontact::test_winding_numbers
