/// Sparse numbers of cells and nodes against a map of all positions, and their memory.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <stdexcept>
#include <tuple>

#include "core/cells/grid_numbers.hpp"

namespace cgcontact::test_grid_numbers {
namespace {

/// Ascending in k, j, i.
struct GridOrder {
  bool operator()(const Index3& a, const Index3& b) const {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
  }
};
using Numbers = std::map<Index3, int, GridOrder>;

Numbers numbered(Numbers positions) {
  int next = 0;
  for (auto& [position, number] : positions) number = next++;
  return positions;
}

/// All positions of the extent, and those around it.
void expect_equal(const GridNumbers& numbers, const Index3& extent, const Numbers& expected) {
  EXPECT_EQ(numbers.size(), expected.size());
  for (int k = -1; k <= extent[2]; ++k)
    for (int j = -1; j <= extent[1]; ++j)
      for (int i = -1; i <= extent[0]; ++i) {
        const auto there = expected.find({i, j, k});
        ASSERT_EQ(numbers.find({i, j, k}), there == expected.end() ? -1 : there->second) << i << ' ' << j << ' ' << k;
      }
  std::vector<int> row(extent[0] + 4);
  for (int k = -1; k <= extent[2]; ++k)
    for (int j = -1; j <= extent[1]; ++j) {
      numbers.find_row({-2, j, k}, extent[0] + 4, row.data());
      for (int i = -2; i < extent[0] + 2; ++i) ASSERT_EQ(row[i + 2], numbers.find({i, j, k}));
      for (int i = -2; i < extent[0] + 2; ++i)
        for (int bit = 0; bit < 64; ++bit)
          ASSERT_EQ(numbers.bits({i, j, k}) >> bit & 1, numbers.find({i + bit, j, k}) >= 0);
    }
  auto next = expected.begin();
  numbers.each([&](const Index3& position) {
    ASSERT_NE(next, expected.end());
    EXPECT_EQ(position, next->first);
    ++next;
  });
  EXPECT_EQ(next, expected.end());
}

TEST(GridNumbers, RandomPositionsOfOddGrids) {
  std::mt19937 random(1);
  for (const Index3& extent :
       {Index3{1, 1, 1}, Index3{63, 3, 2}, Index3{64, 2, 3}, Index3{65, 4, 1}, Index3{1, 130, 7}, Index3{200, 5, 9}})
    for (const double share : {0.0, 0.02, 0.5, 1.0}) {
      std::vector<Index3> positions;
      Numbers expected;
      for (int k = 0; k < extent[2]; ++k)
        for (int j = 0; j < extent[1]; ++j)
          for (int i = 0; i < extent[0]; ++i)
            if (std::uniform_real_distribution<double>(0, 1)(random) < share) {
              expected[{i, j, k}] = 0;
              positions.insert(positions.end(), 1 + random() % 2, {i, j, k});  // some twice
            }
      expected = numbered(expected);
      expect_equal(GridNumbers(extent, positions), extent, expected);
      std::shuffle(positions.begin(), positions.end(), random);
      expect_equal(GridNumbers(extent, positions), extent, expected);
    }
}

TEST(GridNumbers, RowsOverSeveralWords) {
  const Index3 extent{300, 2, 2};
  for (const auto& [first, length] : {std::pair{0, 300}, {0, 64}, {63, 2}, {64, 64}, {5, 250}, {299, 1}, {10, 0}}) {
    GridNumbers numbers(extent);
    numbers.insert_row({first, 1, 1}, length);
    numbers.insert({2, 0, 1});
    numbers.number();
    Numbers expected = {{{2, 0, 1}, 0}};
    for (int i = 0; i < length; ++i) expected[{first + i, 1, 1}] = 0;
    expect_equal(numbers, extent, numbered(expected));
  }
}

TEST(GridNumbers, MoreMayComeLater) {
  GridNumbers numbers({70, 3, 3}, {{5, 1, 1}, {69, 2, 2}});
  numbers.insert({0, 0, 0});
  numbers.insert({66, 2, 2});
  numbers.number();
  expect_equal(numbers, {70, 3, 3}, numbered({{{0, 0, 0}, 0}, {{5, 1, 1}, 0}, {{66, 2, 2}, 0}, {{69, 2, 2}, 0}}));
}

TEST(GridNumbers, CornersOfCells) {
  std::mt19937 random(2);
  for (const Index3& extent : {Index3{1, 1, 1}, Index3{64, 3, 2}, Index3{130, 4, 5}, Index3{63, 1, 1}})
    for (const double share : {0.05, 1.0}) {
      std::vector<Index3> cells;
      Numbers expected;
      for (int k = 0; k < extent[2]; ++k)
        for (int j = 0; j < extent[1]; ++j)
          for (int i = 0; i < extent[0]; ++i) {
            if (std::uniform_real_distribution<double>(0, 1)(random) > share) continue;
            cells.push_back({i, j, k});
            for (int a = 0; a < 8; ++a) expected[{i + (a & 1), j + (a >> 1 & 1), k + (a >> 2)}] = 0;
          }
      expect_equal(GridNumbers(extent, cells).corners(), {extent[0] + 1, extent[1] + 1, extent[2] + 1},
                   numbered(expected));
    }
}

TEST(GridNumbers, NoneAndOutside) {
  EXPECT_EQ(GridNumbers().find({0, 0, 0}), -1);
  EXPECT_EQ(GridNumbers().size(), 0u);
  EXPECT_EQ(GridNumbers({3, 3, 3}).find({1, 1, 1}), -1);
  EXPECT_EQ(GridNumbers({3, 3, 3}, {}).corners().size(), 0u);
  GridNumbers numbers({3, 4, 5});
  for (const Index3& position : {Index3{-1, 0, 0}, Index3{3, 0, 0}, Index3{0, 4, 0}, Index3{0, 0, 5}, Index3{0, 0, -1}})
    EXPECT_THROW(numbers.insert(position), std::logic_error);
  EXPECT_THROW(numbers.insert_row({2, 0, 0}, 2), std::logic_error);
}

/// A plate across the diagonal of a grid whose box has 8e12 cells, and a rod of 1:1000: memory for what there is.
TEST(GridNumbers, EmptyCellsCostNothing) {
  const int n = 20000, width = 50;
  GridNumbers plate({n, n, n});
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < n; ++i) plate.insert_row({i, j * (n / width), n - 1 - i}, 1);
  plate.number();
  EXPECT_EQ(plate.size(), static_cast<std::size_t>(n) * width);
  EXPECT_LT(plate.bytes(), 48 * plate.size());
  EXPECT_EQ(plate.find({0, 0, n - 1}), n * width - width);
  EXPECT_EQ(plate.find({n - 1, (width - 1) * (n / width), 0}), width - 1);
  EXPECT_EQ(plate.find({1, 0, n - 1}), -1);

  GridNumbers rod({20000, 20, 20});
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 20; ++j) rod.insert_row({0, j, k}, 20000);
  rod.number();
  EXPECT_EQ(rod.size(), 8'000'000u);
  EXPECT_LT(rod.bytes(), rod.size());
}

}  // namespace
}  // namespace cgcontact::test_grid_numbers
