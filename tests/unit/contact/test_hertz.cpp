#include <gtest/gtest.h>

#include "contact/groups/indentation.hpp"
#include "contact/results/figures/hertz.hpp"

namespace cgcontact::test_hertz {
namespace {

Material steel() {
  Material material;
  material.youngs_modulus = 210e9;
  material.poisson_ratio = 0.3;
  return material;
}

// A steel ball of 10 mm radius on a steel plane with 100 N: the closed form.
TEST(Hertz, BallOnPlane) {
  const double modulus = effective_modulus(steel(), steel());
  EXPECT_NEAR(modulus, 210e9 / (2 * 0.91), 1);
  const HertzFigures hertz = hertz_point(100, 100, 100, modulus);
  const double a = std::cbrt(3 * 100 * 0.01 / (4 * modulus));
  EXPECT_NEAR(*hertz.a / a, 1, 1e-14);
  EXPECT_NEAR(hertz.b / a, 1, 1e-14);
  EXPECT_NEAR(hertz.p0 / (1.5 * 100 / (3.14159265358979323846 * a * a)), 1, 1e-14);
  EXPECT_NEAR(*hertz.a, 0.186626e-3, 1e-9);
  EXPECT_NEAR(hertz.p0, 1370.88e6, 1e4);
}

// Crossed steel cylinders, R = 50 and 5 mm, 500 N: half axes and pressure with six digits from an independent solution.
TEST(Hertz, CrossedCylinders) {
  const HertzFigures hertz = hertz_point(500, 1 / 0.05, 1 / 0.005, effective_modulus(steel(), steel()));
  EXPECT_NEAR(*hertz.a, 0.739008e-3, 1e-9);
  EXPECT_NEAR(hertz.b, 0.164244e-3, 1e-9);
  EXPECT_NEAR(hertz.p0, 1966.85e6, 1e4);
}

// An ellipse that is nearly a circle is one: no loss of digits in K - E.
TEST(Hertz, NearlyRoundIsRound) {
  const HertzFigures round = hertz_point(100, 100, 100, 1e11), nearly = hertz_point(100, 100, 100.01, 1e11);
  EXPECT_NEAR(*nearly.a / *round.a, 1, 1e-4);
  EXPECT_NEAR(nearly.p0 / round.p0, 1, 1e-4);
  EXPECT_GT(*nearly.a, nearly.b);
}

// A very long ellipse is as wide, and pressed as hard, as a line with the force per length in its middle:
// 2 p0 b pi/4 per length.
TEST(Hertz, LongEllipseIsALine) {
  const HertzFigures ellipse = hertz_point(1000, 1e-4, 100, 1e11);
  const HertzFigures line = hertz_line(3.14159265358979323846 / 2 * ellipse.p0 * ellipse.b, 100, 1e11);
  EXPECT_FALSE(line.a.has_value());
  EXPECT_NEAR(line.b / ellipse.b, 1, 1e-3);
  EXPECT_NEAR(line.p0 / ellipse.p0, 1, 1e-3);
}

}  // namespace
}  // namespace cgcontact::test_hertz
