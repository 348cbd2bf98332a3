/// Patches of a contact face: the end of a zone inside of them, boxes and coarser copies of a problem, and its solution
/// from coarse to fine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "recovery/face/edge_continuation.hpp"
#include "recovery/face/patch_problem.hpp"

namespace cgcontact::test_face_patches {
namespace {

/// Makes a row of patches of 2 mm in plane strain from 0 on.
FaceGrid row_of_patches(int size) {
  FaceGrid grid;
  grid.plane_strain = true;
  grid.size = {1, size};
  grid.spacing = {1, 2e-3};
  grid.low = {-0.5, 0};
  return grid;
}

/// A zone from the end of a face to 40.3 patches, the square of whose pressure falls along a line, 9 Pa^2 per patch;
/// the two closed patches at its end are wrong.
struct LineToTheEdge {
  static constexpr double edge = 40.3, slope = 9;
  FaceGrid grid = row_of_patches(60);
  std::vector<char> inside = std::vector<char>(60, 1);
  std::vector<double> pressure = std::vector<double>(60, 0.0);

  LineToTheEdge() {
    for (int n = 0; n < 39; ++n) pressure[n] = std::sqrt(square(n));
    pressure[39] = 7;
    pressure[40] = 5;
  }
  static double square(int patch) { return slope * (edge - patch - 0.5); }
  /// Integrates the pressure, N/m.
  double force() const { return 2e-3 * 2. / 3 * std::sqrt(slope) * std::pow(edge, 1.5); }
};

/// The line goes on to two patches beyond the zone, farther off a thousandth of the largest square stands against it.
/// The force is the integral of the pressure, so that nothing is scaled: but for the patch at the end of the face,
/// where no slope is known, 2e-7 of the force.
TEST(EdgeContinuation, GoesOnAlongALine) {
  const LineToTheEdge line;
  const std::vector<double> square = continue_to_edge(line.grid, line.inside, line.pressure, line.force());
  const double tolerance = 1e-6 * LineToTheEdge::square(0);
  for (int n = 0; n < 43; ++n) EXPECT_NEAR(square[n], LineToTheEdge::square(n), tolerance) << n;
  for (int n = 43; n < 60; ++n) EXPECT_NEAR(square[n], -1e-3 * LineToTheEdge::square(0), tolerance) << n;
}

TEST(EdgeContinuation, HasTheForce) {
  const LineToTheEdge line;
  const std::vector<double> one = continue_to_edge(line.grid, line.inside, line.pressure, 1),
                            three = continue_to_edge(line.grid, line.inside, line.pressure, 3);
  for (int n = 0; n < 60; ++n) EXPECT_NEAR(three[n], 9 * one[n], 1e-12 * three[0]);
}

/// What is not on the faces is neither continued nor an open patch that ends the zone.
TEST(EdgeContinuation, LeavesPatchesBesideTheFacesAlone) {
  LineToTheEdge line;
  line.inside[42] = 0;
  std::vector<double> square = continue_to_edge(line.grid, line.inside, line.pressure, line.force());
  EXPECT_NEAR(square[41], LineToTheEdge::square(41), 1e-6 * square[0]);
  EXPECT_EQ(square[42], 0);
  std::fill(line.inside.begin() + 41, line.inside.end(), 0);  // the faces end with the zone
  square = continue_to_edge(line.grid, line.inside, line.pressure, line.force());
  EXPECT_NEAR(square[40] / square[39], 25. / 49, 1e-12);
}

/// Around an axis at 0, rings count by their radius over the unit radius: the integral of r sqrt(slope (edge - r)). The
/// radius and the pressure both vary over a patch, which is 2e-4 of the force.
TEST(EdgeContinuation, CountsRingsByTheirRadius) {
  LineToTheEdge line;
  auto meridian = std::make_shared<Meridian>();
  meridian->first = line.grid.centre(0)[1];
  meridian->spacing = 2e-3;
  meridian->unit_radius = 0.05;
  for (int n = 0; n < 60; ++n) meridian->points.emplace_back(line.grid.centre(n)[1], 0.0);
  line.grid.meridian = std::move(meridian);
  const double force = 2e-3 * 2e-3 / 0.05 * 4. / 15 * std::sqrt(9.0) * std::pow(LineToTheEdge::edge, 2.5);
  const std::vector<double> square = continue_to_edge(line.grid, line.inside, line.pressure, force);
  for (int n = 0; n < 43; ++n) EXPECT_NEAR(square[n], LineToTheEdge::square(n), 1e-3 * LineToTheEdge::square(0)) << n;
}

/// Along both axes the square is a plane: fits from inside go on exactly, whatever the closed patches within two and a
/// half of an open one carry, to open ones within two of a closed one. One factor for all sets the force, which is the
/// sum of the patches' middles here. At the ends of the edge too few patches are left to fit.
TEST(EdgeContinuation, GoesOnAlongAPlane) {
  constexpr int rows = 20, columns = 26;
  FaceGrid grid;
  grid.size = {rows, columns};
  grid.spacing = {1e-3, 2e-3};
  const auto plane = [](int patch) { return 100. - 7 * (patch / columns) - 5 * (patch % columns); };
  const auto closed = [&](int patch) { return plane(patch) > -1; };
  const auto to_other = [&](int patch) {
    double least = 1e300;
    for (int n = 0; n < rows * columns; ++n)
      if (closed(n) != closed(patch))
        least = std::min(least, std::hypot(n / columns - patch / columns, n % columns - patch % columns));
    return least;
  };
  std::vector<double> pressure(rows * columns, 0.0);
  double force = 0;
  for (int n = 0; n < rows * columns; ++n) {
    if (closed(n)) pressure[n] = to_other(n) > 2.5 ? std::sqrt(plane(n)) : 1 + n % 3;
    force += std::sqrt(std::max(plane(n), 0.0)) * grid.area();
  }
  const std::vector<double> square = continue_to_edge(grid, std::vector<char>(rows * columns, 1), pressure, force);
  const double factor = square[0] / plane(0);
  EXPECT_NEAR(factor, 1, 0.02);  // the force of patches that the edge cuts is summed here by their middles
  int beyond = 0;
  for (int n = 0; n < rows * columns; ++n) {
    if (n / columns < 3 || n % columns < 3 || (!closed(n) && to_other(n) > 2)) continue;
    EXPECT_NEAR(square[n], factor * plane(n), 1e-10 * square[0]) << n / columns << " " << n % columns;
    beyond += !closed(n);
  }
  EXPECT_GT(beyond, 20);
}

FaceGrid grid_of(int rows, int columns, FaceEnd first, FaceEnd second) {
  FaceGrid grid;
  grid.size = {rows, columns};
  grid.spacing = {0.5, 0.25};
  grid.low = {first == FaceEnd::free ? -3. : 0., second == FaceEnd::free ? 2. : 0.};
  grid.end = {first, second};
  return grid;
}

/// Marks the patches from row and column `first` to `last`.
std::vector<char> marks(const FaceGrid& grid, std::array<int, 2> first, std::array<int, 2> last) {
  std::vector<char> marked(grid.num_patches(), 0);
  for (int i = first[0]; i <= last[0]; ++i)
    for (int j = first[1]; j <= last[1]; ++j) marked[i * grid.size[1] + j] = 1;
  return marked;
}

/// Boxes are blocks of eight patches around what may press, along axes of 16 and more that end freely; they keep
/// symmetry planes, and all of a period.
TEST(PatchBoxes, AreWholeBlocksAroundWhatMayPress) {
  using Box = std::array<std::array<int, 2>, 2>;
  const auto box = [](const FaceGrid& grid, std::array<int, 2> first, std::array<int, 2> last) -> Box {
    const PatchBox found = box_of(grid, marks(grid, first, last));
    return {found.first, found.size};
  };
  const FaceEnd free = FaceEnd::free, mirror = FaceEnd::mirror, period = FaceEnd::period;
  EXPECT_EQ(box(grid_of(40, 15, free, free), {17, 3}, {26, 5}), (Box{{{16, 0}, {16, 15}}}));
  EXPECT_EQ(box(grid_of(40, 16, free, free), {16, 8}, {23, 8}), (Box{{{16, 8}, {8, 8}}}));
  EXPECT_EQ(box(grid_of(40, 16, free, free), {15, 7}, {24, 8}), (Box{{{8, 0}, {24, 16}}}));
  EXPECT_EQ(box(grid_of(44, 16, free, free), {41, 0}, {43, 1}), (Box{{{40, 0}, {4, 8}}}));
  EXPECT_EQ(box(grid_of(40, 40, mirror, period), {17, 17}, {26, 26}), (Box{{{0, 0}, {32, 40}}}));
  const FaceGrid grid = grid_of(40, 40, free, free);
  const PatchBox nothing = box_of(grid, std::vector<char>(grid.num_patches(), 0));
  EXPECT_EQ(nothing.first, (std::array<int, 2>{0, 0}));
  EXPECT_EQ(nothing.size, grid.size);
}

/// The mirror image of what may press has the mirrored box: results of mirrored scenes are alike.
TEST(PatchBoxes, OfMirrorImagesAreMirrored) {
  const FaceGrid grid = grid_of(48, 48, FaceEnd::free, FaceEnd::free);
  for (const auto& [first, last] : {std::pair(0, 0), {7, 9}, {13, 30}, {40, 47}, {23, 24}}) {
    const PatchBox box = box_of(grid, marks(grid, {first, first}, {last, last})),
                   mirrored = box_of(grid, marks(grid, {47 - last, first}, {47 - first, last}));
    EXPECT_EQ(mirrored.first[0], 48 - box.first[0] - box.size[0]) << first;
    EXPECT_EQ(mirrored.size, box.size) << first;
    EXPECT_EQ(mirrored.first[1], box.first[1]) << first;
  }
}

/// A problem of whatever gaps and marks.
PatchProblem some_problem(const FaceGrid& grid) {
  PatchProblem problem{grid, 3, 5, {}, {}};
  for (int n = 0; n < grid.num_patches(); ++n) {
    problem.may_press.push_back(n % 3 != 0 && n % 7 != 1);
    problem.gap.push_back(std::sin(1. + n));
  }
  return problem;
}

TEST(PatchBoxes, HaveTheirPatchesWhereTheWholeGridHasThem) {
  const PatchProblem whole = some_problem(grid_of(9, 6, FaceEnd::free, FaceEnd::free));
  const PatchBox box{{2, 1}, {2, 3}};
  const std::vector<int> patches = patches_of(whole.grid, box);
  EXPECT_EQ(patches, (std::vector<int>{13, 14, 15, 19, 20, 21}));
  const PatchProblem region = cut_out(whole, box);
  EXPECT_EQ(region.grid.size, box.size);
  EXPECT_EQ(region.modulus, 3);
  EXPECT_EQ(region.force, 5);
  ASSERT_EQ(region.gap.size(), patches.size());
  ASSERT_EQ(region.may_press.size(), patches.size());
  for (std::size_t k = 0; k < patches.size(); ++k) {
    EXPECT_LT((region.grid.centre(static_cast<int>(k)) - whole.grid.centre(patches[k])).norm(), 1e-14);
    EXPECT_EQ(region.gap[k], whole.gap[patches[k]]);
    EXPECT_EQ(region.may_press[k], whole.may_press[patches[k]]);
  }
}

/// Two by two, where there are 16 or more, an even number: each covers its patches. Gaps are means over those that may
/// press; what has none may not press.
TEST(CoarsePatches, CoverTheirPatches) {
  for (const auto& [rows, columns, merged] :
       {std::tuple(16, 18, std::array<int, 2>{2, 2}), std::tuple(14, 20, std::array<int, 2>{1, 2}),
        std::tuple(32, 17, std::array<int, 2>{2, 1}), std::tuple(15, 14, std::array<int, 2>{1, 1})}) {
    const PatchProblem fine = some_problem(grid_of(rows, columns, FaceEnd::free, FaceEnd::mirror));
    const CoarsePatches coarse = coarse_patches(fine.grid);
    EXPECT_EQ(coarse.merged, merged);
    EXPECT_EQ(coarse.any(), merged[0] * merged[1] > 1);
    const PatchProblem problem = coarsened(fine, coarse);
    EXPECT_EQ(problem.modulus, 3);
    EXPECT_EQ(problem.force, 5);
    const int count = merged[0] * merged[1];
    ASSERT_EQ(problem.grid.num_patches() * count, fine.grid.num_patches());
    EXPECT_NEAR(problem.grid.area(), count * fine.grid.area(), 1e-14);
    for (int n = 0; n < problem.grid.num_patches(); ++n) {
      FacePosition centre = FacePosition::Zero();
      double gap = 0;
      int patches = 0, pressing = 0;
      for (int k = 0; k < fine.grid.num_patches(); ++k) {
        if (coarse.parent[k] != n) continue;
        centre += fine.grid.centre(k);
        ++patches;
        if (!fine.may_press[k]) continue;
        gap += fine.gap[k];
        ++pressing;
      }
      ASSERT_EQ(patches, count);
      EXPECT_LT((centre / count - problem.grid.centre(n)).norm(), 1e-13);
      EXPECT_EQ(problem.may_press[n], pressing > 0);
      EXPECT_NEAR(problem.gap[n], pressing > 0 ? gap / pressing : 0, 1e-15);
    }
  }
}

/// From coarse to fine or at once, from nothing or from any start: the same pressure, as the problem is convex. A ball,
/// whose zone of radius 1 lies beside the middle of the grid, may not press in a corner of its zone.
TEST(NestedProblem, HasTheSolutionOfTheWholeOne) {
  for (const FaceEnd end : {FaceEnd::free, FaceEnd::mirror}) {
    FaceGrid grid;
    grid.size = {48, 64};
    grid.spacing = {0.09, 0.08};
    grid.end = {end, FaceEnd::free};
    grid.low = {end == FaceEnd::free ? -1.7 : 0, -1.9};
    PatchProblem problem{grid, 1, end == FaceEnd::free ? 4. / 3 : 2. / 3, {}, {}};
    for (int n = 0; n < grid.num_patches(); ++n) {
      const FacePosition x = grid.centre(n);
      problem.gap.push_back(x.squaredNorm() / 2);
      problem.may_press.push_back(x[1] < 0.6 || x[0] > 0.3);
    }
    FaceOptions options;
    const HalfSpace half_space(ExecSpace(), grid, problem.modulus);
    const HalfSpace::Patches gap("gap", 48, 64), whole("p", 48, 64);
    const HalfSpace::Marks may_press("marks", 48, 64);
    const auto host_gap = Kokkos::create_mirror_view(gap);
    const auto host_marks = Kokkos::create_mirror_view(may_press);
    for (int n = 0; n < grid.num_patches(); ++n) {
      host_gap(n / 64, n % 64) = problem.gap[n];
      host_marks(n / 64, n % 64) = problem.may_press[n];
    }
    Kokkos::deep_copy(gap, host_gap);
    Kokkos::deep_copy(may_press, host_marks);
    solve_face_problem(ExecSpace(), grid, half_space, gap, may_press, problem.force, options.tolerance,
                       options.max_iterations, whole);
    const auto expected = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole);
    std::vector<double> any(grid.num_patches());
    for (int n = 0; n < grid.num_patches(); ++n) any[n] = 0.1 * (n % 5);
    for (std::vector<double> p : {std::vector<double>(grid.num_patches(), 0.0), any}) {
      EXPECT_TRUE(solve_nested(ExecSpace(), problem, options, p).converged);
      double largest = 0, worst = 0, sum = 0;
      for (int n = 0; n < grid.num_patches(); ++n) {
        const double exact = expected(n / 64, n % 64);
        largest = std::max(largest, exact);
        worst = std::max(worst, std::abs(p[n] - exact));
        sum += p[n] * grid.area();
        EXPECT_TRUE(problem.may_press[n] || p[n] == 0) << n;
      }
      EXPECT_LT(worst, 1e-6 * largest);  // the last change was 1e-10 of the force
      EXPECT_NEAR(sum / problem.force, 1, 1e-10);
    }
  }
}

}  // namespace
}  // namespace cgcontact::test_face_patches
