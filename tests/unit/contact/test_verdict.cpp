/// Verdicts on hand-made figures of a stack that is on its grids, not solved: which findings count, in which order, and
/// the cells that they ask for.
#include <gtest/gtest.h>

#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "contact/simulation.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/scene_text.hpp"

namespace cgcontact::test_verdict {
namespace {

using State = Verdict::State;

/// Three blocks of 0.5 x 0.4 m with the contacts "low" and "high"; `top`: where the uppermost one ends, m.
std::string stack_text(const std::string& top) {
  const std::string grid = "grid = {offset = [0.3, 0.6, 0.2]}\n";
  return test::box_text("bottom", "[0, 0, 0]", "[0.5, 0.4, 0.6]", 0.13, grid) +
         test::box_text("middle", "[0, 0, 0.6]", "[0.5, 0.4, 1.3]", 0.11, grid) +
         test::box_text("top", "[0, 0, 1.3]", "[0.5, 0.4, " + top + "]", 0.13, grid) +
         test::contact_text("bottom.z+", "middle.z-") + "name = \"low\"\n" + test::contact_text("middle.z+", "top.z-") +
         "name = \"high\"\n" +
         test::symmetry_text({"bottom.x-", "bottom.y-", "bottom.z-", "middle.x-", "middle.y-", "top.x-", "top.y-"});
}

class VerdictOfStack : public testing::Test {
 protected:
  explicit VerdictOfStack(const std::string& top = "2")
      : scene_(parse_scene(stack_text(top), "scene.toml")), simulation_(scene_) {
    simulation_.set_up_grids();
    simulation_.make_system();
    OuterResult& outer = state().outer;
    outer.converged = true;
    outer.support_stress.assign(state().supports.size(), 0.0);
    outer.group_force.assign(state().pairs[0].groups.size() + state().pairs[1].groups.size(), 0.0);
    outer.small_zone_width.resize(2);
    results_.pairs.resize(2);
    results_.pairs[0].name = "low";
    results_.pairs[1].name = "high";
  }

  SolvedState& state() { return simulation_.state; }
  /// Lets a pair carry a force (N) by a zone some cells of 0.1 m across.
  void touch(int pair, double force, double cells_across) {
    PairFigures& figures = results_.pairs[pair];
    figures.active_points = 10;
    figures.area = 0.2;
    figures.force_on_first = Vec3(0, 0, -force);
    state().outer.small_zone_width[pair] = {0.1 * cells_across, 0.1, 1};
  }
  /// Leaves a gap between the faces of a pair, m, that is known but for an error.
  void leave_gap(int pair, double gap, double error) {
    PairFigures& figures = results_.pairs[pair];
    figures.min_gap = gap;
    figures.min_gap_error = error;
    figures.min_gap_at = Vec3(0.1, 0.2, 1.3);
    figures.min_gap_cell = 0.13;
  }
  /// Adds a closed point of a quarter of a square metre, whose pressures agree, Pa.
  ContactRow& add_row(int pair, double pressure, double error) {
    ContactRow row;
    row.pair = pair;
    row.x = Vec3(0.3, 0.2, 0.6);
    row.weight = 0.25;
    row.larger_cell = 0.1;
    row.pressure_raw = row.pressure_spr = row.pressure_sprc = row.pressure_transmitted = pressure;
    row.pressure_error = error;
    row.active = row.touching = true;
    results_.contact_rows.push_back(row);
    return results_.contact_rows.back();
  }
  Verdict verdict() { return judge(state(), results_); }
  /// Returns the verdict after the estimated errors.
  const Verdict& verdict_with_errors() {
    results_.verdict = verdict();
    judge_errors(state(), results_);
    return results_.verdict;
  }

  Scene scene_;
  Simulation simulation_;
  Results results_;
};

/// The whole force that presses a closed zone on, as a shrink fit, is its pressure's, not its resultant.
TEST(PressingForce, IsTheResultantOrThePressureAllAround) {
  PairFigures open, closed;
  open.force_on_first = Vec3(3, 0, -4);
  open.max_pressure = 2;
  open.area = 2;
  closed.max_pressure = 4;
  closed.area = 2;
  EXPECT_DOUBLE_EQ(pressing_force(open), 5);
  EXPECT_DOUBLE_EQ(pressing_force(closed), 8);
  Results results;
  EXPECT_EQ(largest_pressing_force(results.pairs), 0);
  results.pairs = {open, closed, PairFigures()};
  EXPECT_DOUBLE_EQ(largest_pressing_force(results.pairs), 8);
}

TEST_F(VerdictOfStack, IsResolvedFromFiveCellsAcrossOn) {
  touch(0, 1e5, 5.001);
  touch(1, 1e5, 8);
  Verdict v = verdict();
  EXPECT_EQ(v.state, State::resolved) << v.text;
  EXPECT_EQ(v.text, "the contact is resolved: 5 cells across the zone of \"low\", the narrowest");
  ASSERT_EQ(v.pairs.size(), 2u);
  EXPECT_NEAR(*v.pairs[1].cells_across, 8, 1e-12);
  EXPECT_FALSE(v.pairs[0].cell_size_needed);
  touch(1, 1e5, 4.9);
  v = verdict();
  EXPECT_EQ(v.state, State::not_resolved);
  EXPECT_EQ(v.pairs[0].state, State::resolved);
  EXPECT_EQ(v.pairs[1].state, State::not_resolved);
  EXPECT_NEAR(*v.pairs[1].cell_size_needed, 0.049, 1e-12) << "ten cells across";
  expect_contains(v.text,
                  {"the contact zone of \"high\" is 4.9 cells across", "cells of 0.049 m or less in both bodies"});
}

/// Less than a hundredth of the largest force is marked in its pair, and not in the run.
TEST_F(VerdictOfStack, LeavesOutWhatCarriesNextToNothing) {
  touch(0, 1e5, 20);
  for (const double force : {999.0, 1001.0}) {
    touch(1, force, 2);
    const Verdict v = verdict();
    EXPECT_EQ(v.pairs[1].state, State::not_resolved);
    EXPECT_EQ(v.state, force < 1000 ? State::resolved : State::not_resolved) << v.text;
    expect_contains(v.text, {force < 1000 ? "20 cells across the zone of \"low\"" : "\"high\" is 2 cells across"});
  }
}

/// Beside a run that did not converge nothing counts; a contact that was missed comes before zones of few cells.
TEST_F(VerdictOfStack, TellsTheWorstFirst) {
  touch(0, 1e5, 3);
  leave_gap(1, -2e-5, 0);
  Verdict v = verdict();
  EXPECT_EQ(v.state, State::contact_missed);
  EXPECT_EQ(v.pairs[0].state, State::not_resolved);
  EXPECT_EQ(v.pairs[1].state, State::contact_missed);
  EXPECT_NEAR(*v.pairs[1].cell_size_needed, 0.013, 1e-12) << "ten cells across a zone of one cell";
  expect_contains(v.text,
                  {"contact \"high\": no force is transmitted although the faces overlap by up to 2e-05 m at (0.1, "
                   "0.2, 1.3) m",
                   "smaller than a cell (0.13 m), cells of 0.013 m or less"});
  leave_gap(0, -2e-5, 0);  // beside the closed points
  v = verdict();
  EXPECT_EQ(v.pairs[0].state, State::contact_missed);
  ASSERT_TRUE(v.pairs[0].of_closed);
  EXPECT_EQ(*v.pairs[0].of_closed, State::not_resolved);
  EXPECT_FALSE(v.pairs[1].of_closed);
  expect_contains(v.text, {"contact \"low\": no force is transmitted in one of its zones although the faces overlap"});
  state().outer.converged = false;
  state().outer.diagnosis = "it went astray";
  v = verdict();
  EXPECT_EQ(v.state, State::not_converged);
  EXPECT_EQ(v.text, "it went astray");
}

/// A gap of a quarter of its error: the error has to fall to a quarter, with the square of the cells. The force that
/// may be missed is 1.07 E* h (error - gap) of steel on steel, 46 kN: a hundredth of 10 MN is more.
TEST_F(VerdictOfStack, IsUnclearWhereAGapIsWithinItsError) {
  leave_gap(1, 1e-6, 4e-6);
  for (const double force : {1e5, 1e7}) {
    touch(0, force, 20);
    const Verdict v = verdict();
    const bool counts = force < 1e6;
    EXPECT_EQ(v.state, counts ? State::not_resolved : State::resolved) << v.text;
    EXPECT_EQ(v.pairs[1].state, counts ? State::not_resolved : State::no_contact);
    ASSERT_EQ(v.pairs[1].cell_size_needed.has_value(), counts);
    if (counts) {
      EXPECT_NEAR(*v.pairs[1].cell_size_needed, 0.065, 1e-12);
      expect_contains(v.text, {"contact \"high\": whether the faces touch is not resolved",
                               "1e-06 m at (0.1, 0.2, 1.3) m", "displacements, 4e-06 m: cells of 0.065 m or less"});
    }
    EXPECT_EQ(unclear_gap_warnings(state(), results_.pairs).size(), 1u);
  }
  leave_gap(1, 5e-6, 4e-6);
  EXPECT_EQ(verdict().pairs[1].state, State::no_contact);
  EXPECT_TRUE(unclear_gap_warnings(state(), results_.pairs).empty());
}

TEST_F(VerdictOfStack, HasNoZoneToResolveWhereItIsBonded) {
  for (int pair = 0; pair < 2; ++pair) {
    touch(pair, 1e5, 1);
    results_.pairs[pair].bonded = true;
  }
  const Verdict bonded = verdict();
  EXPECT_EQ(bonded.state, State::resolved);
  EXPECT_EQ(bonded.text, "all contact is bonded: no zone to resolve");
  results_.pairs[1].bonded = false;
  EXPECT_EQ(verdict().pairs[0].state, State::resolved);
  EXPECT_EQ(verdict().pairs[1].state, State::not_resolved);
}

TEST_F(VerdictOfStack, HasNoContactWhereNothingTouches) {
  const Verdict v = verdict();
  EXPECT_EQ(v.state, State::no_contact);
  EXPECT_EQ(v.text, "nothing touches: no contact carries a force");
  const Scene alone = parse_scene(test::pulled_bar_text(), "scene.toml");
  Simulation bar(alone);
  bar.set_up_grids();
  bar.make_system();
  bar.state.outer.converged = true;
  EXPECT_EQ(judge(bar.state, Results()).text, "the scene has no contact pair");
}

/// A recovered pressure of half of what all others have there: half as large cells may tell. Of bonded faces it is no
/// pressure, and without SPR-C it is none of its own.
TEST_F(VerdictOfStack, IsNotResolvedWhereThePressureHasAHole) {
  touch(0, 1e5, 20);
  results_.pairs[0].max_pressure = 1e6;
  add_row(0, 1e6, 0).pressure_sprc = 5e5;
  const Verdict v = verdict();
  EXPECT_EQ(v.state, State::not_resolved);
  EXPECT_NEAR(*v.pairs[0].cell_size_needed, 0.05, 1e-12);
  expect_contains(v.text, {"the recovered pressure of \"low\" is 5e+05 Pa at (0.3, 0.2, 0.6) m", "1e+06 to 1e+06 Pa"});
  results_.pairs[0].bonded = true;
  EXPECT_EQ(verdict().state, State::resolved);
  results_.pairs[0].bonded = false;
  scene_.recovery.spr_c = false;
  EXPECT_EQ(verdict().state, State::resolved);
}

/// What holds a body where nothing of the scene does should take nothing: a tenth of the contact force says how wrong
/// that is, 4 % is let pass.
TEST_F(VerdictOfStack, IsNotResolvedWhereItsHoldsTakeForce) {
  touch(0, 1e5, 20);
  touch(1, 1e5, 20);
  state().outer.group_force.assign(state().outer.group_force.size(), 1);
  const BodyModel& bottom = state().bodies[0];
  SupportPoint hold = state().supports[0];
  hold.support = -1;
  hold.body = 0;
  hold.direction = Vec3::UnitZ();
  hold.weight = 1;
  hold.xi = Vec3::Zero();
  const Vec3 middle = 0.5 * (bottom.low + bottom.high);
  for (int cell = 0; cell < static_cast<int>(bottom.cut_cells.cells.size()); ++cell)
    if ((global_position(bottom.cut_cells, cell, hold.xi) - middle).norm() < 0.13) hold.cell = cell;
  state().supports.push_back(hold);
  for (const double fraction : {0.04, 0.1}) {
    state().outer.support_stress.resize(state().supports.size());
    state().outer.support_stress.back() = fraction * normal_forces(state()).at(0);
    const Verdict v = verdict();
    EXPECT_EQ(v.state, fraction < 0.05 ? State::resolved : State::not_resolved) << v.text;
    EXPECT_EQ(v.pairs[0].state, v.state);
    EXPECT_EQ(v.pairs[1].state, State::resolved) << "other bodies";
    if (fraction > 0.05) expect_contains(v.text, {"contact \"low\": what holds its bodies", "takes 10 % of its force"});
  }
}

/// The upper block is a plate of 0.1 m in cells of 0.13 m: 2 V / A, and three cells over its thickness are enough.
class VerdictUnderAPlate : public VerdictOfStack {
 protected:
  VerdictUnderAPlate() : VerdictOfStack("1.4") {}
};

TEST_F(VerdictUnderAPlate, IsNotResolvedWhereABodyIsThinnerThanItsCells) {
  touch(0, 1e5, 20);
  touch(1, 1e5, 20);
  const Verdict v = verdict();
  EXPECT_EQ(v.pairs[0].state, State::resolved);
  EXPECT_EQ(v.pairs[1].state, State::not_resolved);
  EXPECT_NEAR(*v.pairs[1].cell_size_needed, 0.1 / 3, 1e-9);
  expect_contains(v.text, {"body \"top\" is 0.77 cells thick at the contact \"high\"", "cells of 0.033 m or less"});
}

/// Errors of more than half of the pressure's integral leave the order of magnitude; cells of open rows do not count.
TEST_F(VerdictOfStack, IsNotResolvedWhereErrorsAreMoreThanHalfOfThePressure) {
  touch(0, 1e5, 20);
  touch(1, 1e5, 20);
  add_row(0, 1e6, 5e5);
  add_row(1, 1e6, 0);
  ContactRow& open = add_row(0, 0, 0);
  open.active = open.touching = false;
  open.larger_cell = 0.4;
  results_.pairs[0].force_error_estimate = 0.1;
  EXPECT_EQ(verdict_with_errors().state, State::resolved) << "half of it";
  EXPECT_TRUE(results_.pairs[0].force_error_estimate);
  results_.contact_rows[0].pressure_error = 6e5;
  const Verdict& v = verdict_with_errors();
  EXPECT_EQ(v.state, State::not_resolved);
  EXPECT_EQ(v.pairs[0].state, State::not_resolved);
  EXPECT_EQ(v.pairs[1].state, State::resolved);
  EXPECT_NEAR(*v.pairs[0].cell_size_needed, 0.05, 1e-12);
  EXPECT_FALSE(results_.pairs[0].force_error_estimate) << "not known";
  expect_contains(v.text, {"the pressure of \"low\" add up to 0.6 of its integral", "cells of 0.05 m or less"});
  results_.pairs[0].force_error_estimate = 0;
  verdict_with_errors();
  EXPECT_TRUE(results_.pairs[0].force_error_estimate) << "given by the loads";
}

/// A pair with next to no force, and a run that is not resolved anyway.
TEST_F(VerdictOfStack, TellsOfErrorsWhereTheyMatter) {
  touch(0, 1e5, 20);
  touch(1, 500, 20);
  add_row(1, 1e3, 1e3);
  EXPECT_EQ(verdict_with_errors().pairs[1].state, State::not_resolved);
  EXPECT_EQ(results_.verdict.state, State::resolved);
  touch(0, 1e5, 3);
  touch(1, 1e5, 20);
  const std::string before = verdict().text;
  EXPECT_EQ(verdict_with_errors().text, before);
}

}  // namespace
}  // namespace cgcontact::test_verdict
