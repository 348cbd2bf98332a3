/// Locally refined grids: balance of the tree, cut cells of several levels.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/cells/cells_around.hpp"
#include "cut_cells_checks.hpp"

namespace cgcontact::test_cell_tree {
namespace {

/// Index of the cell that contains the given one, some levels up.
Index3 ancestor_of(const Index3& c, int steps) { return {c[0] >> steps, c[1] >> steps, c[2] >> steps}; }

/// All leaves of a tree: (level, index).
std::vector<std::pair<int, Index3>> leaves(const CellTree& tree, const Index3& num_cells) {
  std::vector<std::pair<int, Index3>> found;
  for (int l = 0; l < tree.num_levels(); ++l)
    for (int k = 0; k < num_cells[2] << l; ++k)
      for (int j = 0; j < num_cells[1] << l; ++j)
        for (int i = 0; i < num_cells[0] << l; ++i)
          if (tree.is_leaf(l, {i, j, k})) found.push_back({l, {i, j, k}});
  return found;
}

/// Returns whether a cell and the 26 around it are each covered by a leaf of a level that differs by one at most.
void expect_balanced(const CellTree& tree, const Index3& num_cells) {
  for (const auto& [l, c] : leaves(tree, num_cells))
    for (int n = 0; n < 27; ++n) {
      const Index3 other{c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1};
      bool in_grid = true;
      for (int d = 0; d < 3; ++d) in_grid &= other[d] >= 0 && other[d] < num_cells[d] << l;
      if (!in_grid) continue;
      bool covered = tree.is_refined(l, other) || tree.is_leaf(l, other);
      covered = covered || (l > 0 && tree.is_leaf(l - 1, ancestor_of(other, 1)));
      ASSERT_TRUE(covered) << "level " << l << ": the neighbour is larger by two levels";
    }
}

double covered_volume(const CellTree& tree, const Index3& num_cells) {
  double volume = 0;
  for (const auto& leaf : leaves(tree, num_cells)) volume += std::pow(0.125, leaf.first);
  return volume;
}

TEST(CellTree, IsBalancedAndCoversTheGridOnce) {
  const Index3 n{3, 2, 4};
  std::vector<std::vector<Index3>> refined(5);
  refined[4] = {{33, 17, 9}};  // one cell of level 4 and what that needs
  refined[2] = {{0, 0, 15}};
  const CellTree tree(n, refined);
  EXPECT_EQ(tree.num_levels(), 6);
  EXPECT_TRUE(tree.is_refined(0, {2, 1, 0}));
  EXPECT_NEAR(covered_volume(tree, n), 24, 1e-12);
  expect_balanced(tree, n);
}

TEST(CellTree, CoarsenedIsBalancedAndEndsAtTheGrid) {
  const Index3 n{2, 2, 2};
  std::vector<std::vector<Index3>> refined(4);
  refined[3] = {{0, 3, 5}, {1, 3, 5}};
  CellTree tree(n, refined);
  std::size_t before = leaves(tree, n).size();
  for (int levels = 5; levels > 1; --levels) {
    ASSERT_EQ(tree.num_levels(), levels);
    tree = tree.coarsened();
    const std::size_t now = leaves(tree, n).size();
    EXPECT_LT(now, before);
    before = now;
    EXPECT_NEAR(covered_volume(tree, n), 8, 1e-12);
    expect_balanced(tree, n);
  }
  EXPECT_EQ(before, 8u) << "the grid";
}

TEST(CellTree, RefusesMoreThanNumbersHold) {
  std::vector<std::vector<Index3>> refined(30);
  refined[29] = {{0, 0, 0}};
  EXPECT_THROW(CellTree({5, 5, 5}, refined), InputError);
}

// A ball of 8 cells of size 1/8 towards its middle: as many divided cells as are allowed are made, one less is refused.
TEST(CellTree, RefusesMoreDividedCellsThanAllowed) {
  const Solid ball = Solid::sphere({4, 4, 4}, 4, "ball");
  Grid grid;
  grid.num_cells = {8, 8, 8};
  const auto wanted = [](const Vec3& low, const Vec3& high) {
    const Vec3 middle(4, 4, 4);
    return 0.125 + (middle - middle.cwiseMax(low).cwiseMin(high)).norm();
  };
  const CellTree tree = refine_cells(ball.geometry(), grid, wanted, 4);
  double divided = 0;  // the balance asks for none: sizes grow by no more than the distance
  for (int l = 0; l + 1 < tree.num_levels(); ++l) tree.refined(l).each([&](const Index3&) { ++divided; });
  ASSERT_GT(divided, 20);
  EXPECT_EQ(refine_cells(ball.geometry(), grid, wanted, 4, divided).num_levels(), tree.num_levels());
  EXPECT_THROW(refine_cells(ball.geometry(), grid, wanted, 4, divided - 1), TooManyCells);
}

/// A body in its grid, refined towards a point.
CutCells refined_cells(const Solid& solid, const Grid& grid, const Vec3& point, double finest, double slope,
                       int levels) {
  const auto wanted = [&](const Vec3& low, const Vec3& high) {
    return std::max(finest, slope * (point - point.cwiseMax(low).cwiseMin(high)).norm());
  };
  return make_cut_cells(solid, grid, {}, {}, refine_cells(solid.geometry(), grid, wanted, levels));
}

/// Volume in cells of level 0, from the cells of all levels.
double volume(const CutCells& cells) {
  double sum = 0;
  for (int a = 0; a < static_cast<int>(cells.cells.size()); ++a)
    sum += std::pow(cells.size(a), 3) * cells.volume_fraction(a);
  return sum;
}

double area(const CutCells& cells) {
  double sum = 0;
  for (const double w : cells.boundary.weight) sum += w;
  return sum;
}

void expect_consistent(const CutCells& cells) {
  ASSERT_EQ(cells.level_cells.size(), static_cast<std::size_t>(cells.num_levels()));
  for (int a = 0; a < static_cast<int>(cells.cells.size()); ++a) {
    EXPECT_EQ(cells.find(cells.level(a), cells.cells[a]), a);
    const Vec3 middle = grid_position(cells, a, Vec3::Zero());
    EXPECT_EQ(cells.locate(middle), a);
    EXPECT_LT(cell_coordinates(cells, a, middle).norm(), 1e-12);
    const CutCells& of_level = cells.level_cells[cells.level(a)];
    const int own = a - cells.first_of_level[cells.level(a)];
    EXPECT_EQ(of_level.volume_fraction(own), cells.volume_fraction(a));
  }
  for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
    const Vec3 xi = cell_coordinates(cells, cells.boundary.cell[i], cells.boundary.position[i]);
    EXPECT_LT(xi.lpNorm<Eigen::Infinity>(), 1 + 1e-9) << "a point outside of its cell";
  }
}

TEST(RefinedCutCells, BallHasItsVolumeAndArea) {
  const Solid ball = Solid::sphere({4.1, 3.9, 4.2}, 3.3, "ball");
  Grid grid;
  grid.num_cells = {8, 8, 8};
  const CutCells cells = refined_cells(ball, grid, {4.1, 3.9, 7.5}, 1. / 16, 0.5, 6);
  EXPECT_EQ(cells.num_levels(), 5);
  // Cells of level 0 are a third of the radius: their curved facets are integrated to 1e-7.
  EXPECT_NEAR(volume(cells), 4. / 3 * pi * std::pow(3.3, 3), 1e-5);
  EXPECT_NEAR(area(cells), 4 * pi * 3.3 * 3.3, 1e-5);
  expect_consistent(cells);
}

TEST(RefinedCutCells, BoxIsExactInAnyPosition) {
  for (const double angle : {0.0, 0.4}) {
    const Solid box = Solid::box({-1.5, -1.2, -1}, {1.6, 1.1, 1.3}, "box")
                          .transformed(rotation({1, 2, 3}, angle), Vec3(4.03, 4.01, 3.96));
    Grid grid;
    grid.num_cells = {8, 8, 8};
    const Vec3 corner = rotation({1, 2, 3}, angle) * Vec3(1.6, 1.1, 1.3) + Vec3(4.03, 4.01, 3.96);
    const CutCells cells = refined_cells(box, grid, corner, 1. / 64, 0.4, 7);
    EXPECT_EQ(cells.num_levels(), 7);
    EXPECT_NEAR(volume(cells), 3.1 * 2.3 * 2.3, 1e-12);
    EXPECT_NEAR(area(cells), 2 * (3.1 * 2.3 + 3.1 * 2.3 + 2.3 * 2.3), 1e-11);
    expect_consistent(cells);
    // The same facets again, cell by cell, also divided by planes that are those of no grid.
    std::vector<Plane> dividers;
    for (int d = 0; d < 3; ++d)
      for (double at = 0.37; at < 8; at += 0.61) dividers.push_back({Vec3::Unit(d), at});
    EXPECT_NEAR(area_by_cells(cells, dividers, 2), area(cells), 1e-11);
  }
}

/// Faces on grid planes of all levels, also by a rounding beyond them, and on the border of the grid: facets in cells
/// without volume go to active cells, none of them larger than its cell.
TEST(RefinedCutCells, FacesOnGridPlanes) {
  for (const double off : {0.0, 1e-14, -1e-14, 3e-13, -3e-13}) {
    const Solid box = Solid::box(Vec3(1, 1, 0), Vec3(4 + off, 3.5 - off, 2 + off), "box");
    Grid grid;
    grid.num_cells = {5, 5, 3};
    for (const Vec3& point : {Vec3(4, 2, 1), Vec3(1, 1, 0), Vec3(2.3, 3.5, 2)}) {
      const CutCells cells = refined_cells(box, grid, point, 1. / 8, 0.5, 5);
      ASSERT_EQ(cells.num_levels(), 4);
      EXPECT_NEAR(volume(cells), 3 * 2.5 * 2, 1e-11) << off;
      EXPECT_NEAR(area(cells), 2 * (3 * 2.5 + 3 * 2 + 2.5 * 2), 1e-11) << off;
      EXPECT_NEAR(area_by_cells(cells, {}, 2), area(cells), 1e-11);
      expect_consistent(cells);
    }
  }
}

/// Cells within some cells of a few of all levels: beside a plain comparison of all with all, at any reach.
TEST(RefinedCutCells, CellsAround) {
  const Solid ball = Solid::sphere({4.1, 3.9, 4.2}, 3.3, "ball");
  Grid grid;
  grid.num_cells = {8, 8, 8};
  const CutCells cells = refined_cells(ball, grid, {4.1, 3.9, 7.5}, 1. / 16, 0.5, 6);
  const int num_cells = static_cast<int>(cells.cells.size());
  std::vector<int> some;
  for (int a = 0; a < num_cells; a += num_cells / 9) some.push_back(a);
  for (const int reach : {0, 1, 5, 30, 1000, std::numeric_limits<int>::max()}) {
    std::vector<char> marked(cells.cells.size(), 0);
    mark_cells_around(cells, some, reach, marked);
    for (int a = 0; a < num_cells; ++a) {
      const Vec3 middle = grid_position(cells, a, Vec3::Zero());
      const bool near = std::any_of(some.begin(), some.end(), [&](int b) {
        const double apart = (grid_position(cells, b, Vec3::Zero()) - middle).lpNorm<Eigen::Infinity>();
        return apart < (reach + 0.5) * cells.size(b) + 0.5 * cells.size(a) - 1e-9;
      });
      ASSERT_EQ(marked[a] != 0, near) << "cell " << a << ", reach " << reach;
    }
  }
}

/// Components of one cell after the other, by walks from cell to cell.
std::vector<int> components_by_walks(const CutCells& cells, int& count) {
  std::vector<int> component(cells.cells.size(), -1), waiting;
  count = 0;
  for (int start = 0; start < static_cast<int>(component.size()); ++start) {
    if (component[start] >= 0) continue;
    waiting.push_back(start);
    component[start] = count;
    while (!waiting.empty()) {
      const int cell = waiting.back();
      waiting.pop_back();
      each_cell_beside(cells, cell, [&](int beside) {
        if (component[beside] < 0) waiting.push_back(beside);
        component[beside] = count;
      });
    }
    ++count;
  }
  return component;
}

/// Combs with teeth along every axis, longer than a word of 64 cells, of one level and of four: the components of walks
/// from cell to cell, with the same numbers. A slit ends within the body, so that walks go around its end.
TEST(RefinedCutCells, ConnectedComponents) {
  for (int along = 0; along < 3; ++along) {
    Vec3 size(9.3, 8.4, 7.6);
    size[along] = 140.3;
    Solid comb = Solid::box(Vec3::Constant(0.2), size, "comb");
    const int across = (along + 1) % 3;
    for (int slit = 0; slit < 3; ++slit) {  // two through the body, one not
      Vec3 low = Vec3::Constant(-1), high = Vec3::Constant(200);
      low[across] = 2 + 2 * slit;
      high[across] = low[across] + 1;
      if (slit == 2) high[along] = 70.5;
      comb = Solid::subtract(comb, Solid::box(low, high, "slit"));
    }
    Grid grid;
    for (int d = 0; d < 3; ++d) grid.num_cells[d] = static_cast<int>(size[d]) + 2;
    Vec3 corner = Vec3::Constant(4.2);
    corner[along] = 66;
    for (const CutCells& cells : {make_cut_cells(comb, grid), refined_cells(comb, grid, corner, 1. / 8, 0.5, 4)}) {
      int count = 0, expected_count = 0;
      const std::vector<int> components = find_connected_components(cells, count);
      const std::vector<int> expected = components_by_walks(cells, expected_count);
      EXPECT_EQ(expected_count, 3);
      EXPECT_EQ(count, expected_count);
      EXPECT_EQ(components, expected);
    }
  }
}

/// Cells of one size by a tree that refines everything once: those of the grid of half the size.
TEST(RefinedCutCells, UniformTreeIsTheFinerGrid) {
  const Solid ball = Solid::sphere({3.1, 2.9, 3.2}, 2.3, "ball");
  Grid grid;
  grid.num_cells = {6, 6, 6};
  const CutCells refined = refined_cells(ball, grid, {3, 3, 3}, 0.5, 0, 2);
  Grid half = grid;
  half.cell_size = 0.5;
  half.num_cells = {12, 12, 12};
  const CutCells uniform = make_cut_cells(ball.transformed(Mat3::Identity(), Vec3::Zero(), 2), half);
  ASSERT_EQ(refined.cells.size(), uniform.cells.size());
  EXPECT_EQ(refined.cells, uniform.cells);
  ASSERT_EQ(refined.moments.size(), uniform.moments.size());
  for (std::size_t c = 0; c < uniform.moments.size(); ++c) EXPECT_EQ(refined.moments[c], uniform.moments[c]);
  ASSERT_EQ(refined.boundary.size(), uniform.boundary.size());
  for (std::size_t i = 0; i < uniform.boundary.size(); ++i) {
    EXPECT_EQ(Vec3(2 * refined.boundary.position[i]), uniform.boundary.position[i]);
    EXPECT_EQ(4 * refined.boundary.weight[i], uniform.boundary.weight[i]);
  }
}

}  // namespace
}  // namespace cgcontact::test_cell_tree
