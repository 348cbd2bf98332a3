// The law of contact: what pressure, stiffness and energy have to do with each other.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/kernels/contact_law.hpp"

namespace cgcontact::test_contact_law {
namespace {

constexpr double k = 3, step = 1e-5;

/// Differences are wrong by step^2 where the law is smooth (it is quadratic: by rounding alone), and by k step at the
/// kink of the pressure.
void expect_derivatives(const NormalContact& law, double lagged, double gap) {
  const double energy = (law.energy(lagged, gap + step) - law.energy(lagged, gap - step)) / (2 * step);
  EXPECT_NEAR(energy, -law.pressure(lagged, gap), k * step) << gap;
  const bool at_kink = !law.bonded && std::abs(law.closed_pressure(lagged, gap)) <= k * step;
  if (at_kink) return;
  const double pressure = (law.pressure(lagged, gap + step) - law.pressure(lagged, gap - step)) / (2 * step);
  EXPECT_NEAR(pressure, -law.stiffness(lagged, gap), 1e-9) << gap;
}

TEST(ContactLaw, PressureIsTheDerivativeOfTheEnergy) {
  for (const bool bonded : {false, true})
    for (const double lagged : {-1.0, 0.0, 2.0})
      for (double gap = -1; gap <= 1; gap += 0.125) expect_derivatives({k, bonded}, lagged, gap);
}

TEST(ContactLaw, OpenPointsNeitherPressNorPull) {
  const NormalContact law{k, false};
  EXPECT_EQ(law.pressure(2, 0.5), 0.5);
  for (const double gap : {0.7, 1.0, 5.0}) {
    EXPECT_EQ(law.pressure(2, gap), 0) << gap;
    EXPECT_EQ(law.stiffness(2, gap), 0) << gap;
    EXPECT_EQ(law.energy(2, gap), 0) << gap;
  }
}

TEST(ContactLaw, BondedPointsPull) {
  const NormalContact law{k, true};
  EXPECT_EQ(law.pressure(2, 1), -1);
  EXPECT_EQ(law.stiffness(2, 1), k);
}

/// Convex: the energy of a mean gap is at most the mean of the energies.
TEST(ContactLaw, EnergyIsConvex) {
  for (const bool bonded : {false, true}) {
    const NormalContact law{k, bonded};
    for (double a = -1; a <= 1; a += 0.1)
      for (double b = -1; b <= 1; b += 0.1)
        EXPECT_LE(law.energy(1, (a + b) / 2), (law.energy(1, a) + law.energy(1, b)) / 2 + 1e-15);
  }
}

}  // namespace
}  // namespace cgcontact::test_contact_law
