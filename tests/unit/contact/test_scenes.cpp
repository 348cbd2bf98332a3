/// The scenes with known answers, at the sizes and bounds that the project promises (README, "Accuracy").
#include <gtest/gtest.h>

#include "tests/support/run_scene.hpp"

namespace cgcontact {
namespace {

TEST(TwoSolids, PressureErrorsStayWithinTheBounds) {
  struct Bound {
    const char* n;
    double whole, ratio, interior_ratio;
  };
  for (const Bound& b : {Bound{"n=8", 0.18, 1.4, 2.0}, Bound{"n=16", 0.09, 1.5, 2.5}, Bound{"n=32", 0.05, 1.6, 3.0}}) {
    const auto solved = test::run_scene("scenes/two_solids.toml", {b.n});
    const Results& r = solved->results();
    EXPECT_TRUE(r.converged) << b.n;
    EXPECT_LE(r.outer_iterations, 10) << b.n;
    const ZoneError &whole = test::zone(r, "whole"), &interior = test::zone(r, "interior");
    EXPECT_LE(whole.sprc, b.whole) << b.n;
    EXPECT_GE(whole.spr / whole.sprc, b.ratio) << b.n;
    EXPECT_GE(interior.spr / interior.sprc, b.interior_ratio) << b.n;
    const double thickness = 0.01 / (1.3 * std::stod(b.n + 2));
    const double force_error = std::abs(r.pairs[0].force_on_first[2]) / (0.5 * 39179.7 * thickness) - 1;
    EXPECT_LE(std::abs(force_error), std::string(b.n) == "n=8" ? 0.03 : 0.01) << b.n;
  }
}

TEST(Rings, PressureConvergesAndTheEstimateIsHonest) {
  std::vector<double> error;
  for (const char* n : {"n=8", "n=16", "n=32"}) {
    const auto solved = test::run_scene("scenes/rings.toml", {n});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << n << " " << r.diagnosis;
    const ZoneError& whole = test::zone(r, "whole");
    error.push_back(whole.sprc);
    if (std::string(n) == "n=16") {
      EXPECT_LE(whole.sprc, 0.025);
      EXPECT_GE(whole.spr / whole.sprc, 3.0);
      EXPECT_GE(r.effectivity, 0.9);
      EXPECT_LE(r.effectivity, 1.15);
    }
  }
  EXPECT_GE(std::log2(error[0] / error[2]) / 2, 1.5);
}

}  // namespace
}  // namespace cgcontact
