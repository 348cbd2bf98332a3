/// Wanted sizes around positions, against a plain loop over all of them.
#include <gtest/gtest.h>

#include <random>

#include "core/cells/size_field.hpp"

namespace cgcontact::test_size_field {
namespace {

TEST(SizeField, AsksForWhatALoopOverAllBallsAsksFor) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  const double grading = 0.25;
  std::vector<SizedBall> balls;
  for (int i = 0; i < 300; ++i) balls.push_back({point(), 0.05 * uniform(random), 0.001 + 0.05 * uniform(random)});
  const SizeField field(balls, grading);
  int yes = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x = point();
    const double radius = 0.02 * uniform(random), size = 0.08 * uniform(random);
    bool expected = false;
    for (const SizedBall& ball : balls) {
      const double distance = std::max(0.0, (ball.center - x).norm() - ball.radius - radius);
      expected |= std::max(ball.size, grading * distance) < size;
    }
    EXPECT_EQ(field.asks_below(size, x, radius), expected) << i;
    yes += expected;
  }
  EXPECT_GT(yes, 300);
  EXPECT_LT(yes, 2700);
}

TEST(SizeField, WithoutBallsNothingIsWanted) {
  EXPECT_FALSE(SizeField({}, 0.5).asks_below(1e9, Vec3::Zero(), 1));
  EXPECT_FALSE(SizeField({{Vec3::Zero(), 0, 1.0}}, 0.5).asks_below(1.0, Vec3::Zero(), 0)) << "as small already";
}

}  // namespace
}  // namespace cgcontact::test_size_field
