/// Holes and spikes in the recovered pressure that no error in the mean tells of (docs/recovery.md, "Error figures").
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/results/verdict/pressure_jumps.hpp"

namespace cgcontact::test_pressure_jumps {
namespace {

constexpr double p0 = 2e9, a = 1e-3, h = 1e-4;
const ResultOptions options;

/// Hertz's zone on a plane, ten cells over its radius, nine rows in every cell; all pressures alike.
std::vector<ContactRow> round_zone() {
  std::vector<ContactRow> rows;
  for (double x = -1.5 * a + h / 6; x < 1.5 * a; x += h / 3)
    for (double y = -1.5 * a + h / 6; y < 1.5 * a; y += h / 3) {
      ContactRow row;
      row.x = Vec3(x, y, 0);
      row.larger_cell = h;
      row.weight = h * h / 9;
      row.pressure_sprc = p0 * std::sqrt(std::max(0.0, 1 - row.x.squaredNorm() / (a * a)));
      row.pressure_raw = row.pressure_spr = row.pressure_transmitted = row.pressure_sprc;
      row.active = row.touching = row.pressure_sprc > 0;
      rows.push_back(row);
    }
  return rows;
}

/// Multiplies the recovered pressure of the rows within a cell of a point.
void change_near(std::vector<ContactRow>& rows, const Vec3& x, double factor) {
  for (ContactRow& row : rows)
    if ((row.x - x).norm() < h) row.pressure_sprc *= factor;
}

TEST(PressureJumps, NoneWhereThePressuresAgree) { EXPECT_TRUE(pressure_jumps(round_zone(), {p0}, options).empty()); }

TEST(PressureJumps, FindsAHoleAndItsPosition) {
  std::vector<ContactRow> rows = round_zone();
  const Vec3 position(2 * h, -h, 0);
  change_near(rows, position, 0.6);
  const std::vector<PressureJump> jumps = pressure_jumps(rows, {p0}, options);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_LE((jumps[0].x - position).norm(), h);
  EXPECT_NEAR(jumps[0].pressure, 0.6 * p0, 0.03 * p0);  // the zone falls by 3 % within three cells of its middle
  EXPECT_GT(jumps[0].around_least, 0.9 * p0);
  EXPECT_FALSE(jumps[0].is_spike());
  double wrong = 0, force = 0;  // the others have 0.93 p0 or more within 1.5 cells
  for (const ContactRow& row : rows) {
    force += row.weight * row.pressure_sprc;
    if ((row.x - position).norm() < h) wrong += row.weight * (0.93 * p0 - row.pressure_sprc);
  }
  EXPECT_NEAR(jumps[0].force_fraction, wrong / force, 0.2 * wrong / force);
}

TEST(PressureJumps, FindsASpike) {
  std::vector<ContactRow> rows = round_zone();
  change_near(rows, Vec3::Zero(), 1.2);
  const std::vector<PressureJump> jumps = pressure_jumps(rows, {1.2 * p0}, options);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_TRUE(jumps[0].is_spike());
}

// Where the finite element stress and plain SPR are unsure by as much themselves, nothing tells which one is right.
TEST(PressureJumps, LeavesPointsAloneWhereTheOthersDisagree) {
  std::vector<ContactRow> rows = round_zone();
  change_near(rows, Vec3::Zero(), 0.6);
  for (ContactRow& row : rows) row.pressure_raw *= row.x.norm() < 3 * h ? 1.5 : 1;
  EXPECT_TRUE(pressure_jumps(rows, {p0}, options).empty());
}

// In a body that locks the finite element stress and plain SPR are wrong alike, and SPR-C carries the forces.
TEST(PressureJumps, LeavesPointsAloneWhereItCarriesTheForces) {
  std::vector<ContactRow> rows = round_zone();
  change_near(rows, Vec3::Zero(), 0.6);
  for (ContactRow& row : rows) row.pressure_transmitted = row.pressure_sprc;
  EXPECT_TRUE(pressure_jumps(rows, {p0}, options).empty());
}

// The square root at the end of the zone is what SPR-C is for.
TEST(PressureJumps, LeavesTheEdgeAlone) {
  std::vector<ContactRow> rows = round_zone();
  change_near(rows, Vec3(a - h / 2, 0, 0), 3.0);
  EXPECT_TRUE(pressure_jumps(rows, {p0}, options).empty());
}

TEST(PressureJumps, KeepsPairsAndBodiesApart) {
  std::vector<ContactRow> rows = round_zone(), others = round_zone();
  for (ContactRow& row : others) {
    row.pair = 1;
    row.pressure_raw = row.pressure_spr = row.pressure_transmitted = row.pressure_sprc = row.pressure_sprc / 4;
  }
  rows.insert(rows.end(), others.begin(), others.end());
  EXPECT_TRUE(pressure_jumps(rows, {p0, p0 / 4}, options).empty());
  change_near(rows, Vec3::Zero(), 0.5);
  EXPECT_EQ(pressure_jumps(rows, {p0, p0 / 4}, options).size(), 2u);
}

}  // namespace
}  // namespace cgcontact::test_pressure_jumps
