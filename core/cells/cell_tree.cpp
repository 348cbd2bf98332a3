#include "core/cells/cell_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors/errors.hpp"
#include "core/geometry/body_geometry.hpp"

namespace cgcontact {
namespace {

/// Calls use(neighbour) for the cells of the 3 x 3 x 3 block that are in the grid.
template <class Use>
void each_around(const Index3& cell, const Index3& extent, const Use& use) {
  for (int n = 0; n < 27; ++n) {
    const Index3 c{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
    bool in_grid = true;
    for (int d = 0; d < 3; ++d) in_grid &= c[d] >= 0 && c[d] < extent[d];
    if (in_grid) use(c);
  }
}

}  // namespace

CellTree::CellTree(const Index3& num_cells, const std::vector<std::vector<Index3>>& refined) : num_cells_(num_cells) {
  int levels = static_cast<int>(refined.size());
  while (levels > 0 && refined[levels - 1].empty()) --levels;
  for (const int n : num_cells)
    if (levels > 0 && static_cast<double>(n) * std::pow(2.0, levels) > std::numeric_limits<int>::max())
      throw InputError(
          fmt::format("{} cells and {} levels of refinement are more than 32-bit numbers hold", n, levels));
  refined_.resize(levels);
  for (int l = levels - 1; l >= 0; --l) {
    refined_[l] = GridNumbers(cells_of_level(num_cells, l));
    for (const Index3& cell : refined[l]) refined_[l].insert(cell);
    if (l + 1 < levels)
      refined_[l + 1].each([&](const Index3& cell) {
        each_around(cell, cells_of_level(num_cells, l + 1), [&](const Index3& c) {
          refined_[l].insert({c[0] >> 1, c[1] >> 1, c[2] >> 1});
        });
      });
    refined_[l].number();
  }
}

bool CellTree::is_refined_in(int level, const Vec3& low, const Vec3& high) const {
  if (level >= static_cast<int>(refined_.size())) return false;
  return is_refined_in(0, {0, 0, 0}, {num_cells_[0] - 1, num_cells_[1] - 1, num_cells_[2] - 1}, level, low, high);
}

bool CellTree::is_refined_in(int from, const Index3& first, const Index3& last, int level, const Vec3& low,
                             const Vec3& high) const {
  Index3 begin, end;
  for (int d = 0; d < 3; ++d) {
    const auto cell_at = [&](double x) {
      return static_cast<int>(std::floor(std::clamp(std::ldexp(x, from), first[d] - 1.0, last[d] + 1.0)));
    };
    begin[d] = std::max(first[d], cell_at(low[d]));
    end[d] = std::min(last[d], cell_at(high[d]));
  }
  Index3 c;
  for (c[2] = begin[2]; c[2] <= end[2]; ++c[2])
    for (c[1] = begin[1]; c[1] <= end[1]; ++c[1])
      for (c[0] = begin[0]; c[0] <= end[0]; ++c[0]) {
        if (refined_[from].find(c) < 0) continue;
        if (from == level) return true;
        const Index3 child{2 * c[0], 2 * c[1], 2 * c[2]};
        if (is_refined_in(from + 1, child, {child[0] + 1, child[1] + 1, child[2] + 1}, level, low, high)) return true;
      }
  return false;
}

CellTree CellTree::coarsened() const {
  std::vector<std::vector<Index3>> refined(num_levels() > 2 ? num_levels() - 2 : 0);
  for (std::size_t l = 0; l < refined.size(); ++l)
    refined_[l + 1].each([&](const Index3& c) { refined[l].push_back({c[0] >> 1, c[1] >> 1, c[2] >> 1}); });
  return CellTree(num_cells_, refined);
}

Index3 CellTree::clamped(int level, Index3 cell) const {
  const Index3 extent = cells_of_level(num_cells_, level);
  for (int d = 0; d < 3; ++d) cell[d] = std::clamp(cell[d], 0, extent[d] - 1);
  return cell;
}

CellTree refine_cells(const BodyGeometry& body, const Grid& grid,
                      const std::function<double(const Vec3&, const Vec3&)>& wanted, int max_levels,
                      double max_divided) {
  if (max_levels == 1) return {};
  std::vector<std::vector<Index3>> refined(max_levels - 1);
  double divided = 0;
  const std::function<void(int, const Index3&)> visit = [&](int level, const Index3& cell) {
    if (level + 1 >= max_levels) return;
    const double size = std::ldexp(1.0, -level);
    const Vec3 low = size * Vec3(cell[0], cell[1], cell[2]), high = low + Vec3::Constant(size);
    if (!(wanted(low, high) < 0.999 * size)) return;
    std::vector<signed char> sides(body.surfaces().size(), -1);
    if (body.side_of_block(0.5 * (low + high), Vec3::Constant(0.5 * size), sides) == 0) return;
    if (++divided > max_divided)
      throw TooManyCells(fmt::format("more than {:.0f} cells would be divided into smaller ones", max_divided));
    refined[level].push_back(cell);
    for (int a = 0; a < 8; ++a)
      if (!grid.is_quadtree() || (a >> grid.plane_strain & 1) == 0)
        visit(level + 1, {2 * cell[0] + (a & 1), 2 * cell[1] + (a >> 1 & 1), 2 * cell[2] + (a >> 2)});
  };
  for (int k = 0; k < grid.num_cells[2]; ++k)
    for (int j = 0; j < grid.num_cells[1]; ++j)
      for (int i = 0; i < grid.num_cells[0]; ++i) visit(0, {i, j, k});
  return CellTree(grid.num_cells, refined);
}

}  // namespace cgcontact
