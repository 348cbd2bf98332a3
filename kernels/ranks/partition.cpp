#include "kernels/ranks/partition.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace cgcontact {
namespace {

/// Of a cut cell, in terms of an interior one: its own forces, those of the full cells beside it, its ghost faces and
/// its blocks in the smoother. Of a linear solve it takes 10 times as long as an interior one with AVX2 (two_solids_3d,
/// n = 56).
constexpr double weight_of_cut_cell = 10;

constexpr int block = 4;  // cells
constexpr int bits = 20;  // of the curve, per direction

std::uint64_t spread(std::uint64_t x) {  // two zeros after every bit
  x &= (1u << bits) - 1;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

Index3 block_of(const Index3& cell) { return {cell[0] / block, cell[1] / block, cell[2] / block}; }

/// Blocks of one part with the weight of their cells.
struct Blocks {
  GridNumbers numbers;
  std::vector<Vec3> place;  ///< m, global axes
  std::vector<double> weight;
};

Blocks make_blocks(const BodyMesh& part) {
  const CutCells& cells = *part.cut_cells;
  const Index3& n = cells.grid.num_cells;
  Blocks blocks;
  blocks.numbers = GridNumbers({n[0] / block + 1, n[1] / block + 1, n[2] / block + 1});
  for (const Index3& c : cells.cells) blocks.numbers.insert(block_of(c));
  blocks.numbers.number();
  blocks.weight.assign(blocks.numbers.size(), 0.0);
  for (std::size_t e = 0; e < cells.cells.size(); ++e)
    blocks.weight[blocks.numbers.find(block_of(cells.cells[e]))] += cells.cut_of_active[e] < 0 ? 1 : weight_of_cut_cell;
  blocks.numbers.each([&](const Index3& b) {
    blocks.place.push_back(cells.grid.to_global(block * (Vec3(b[0], b[1], b[2]) + Vec3::Constant(0.5))));
  });
  return blocks;
}

}  // namespace

void own_nodes(const ElasticSystem& system, const std::vector<std::vector<int>>& together, Owners& owners) {
  owners.of_node.assign(system.num_nodes, -1);
  const std::vector<const BodyMesh*> parts = system.parts();
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t e = 0; e < parts[p]->cell_nodes.size(); ++e)
      for (const int node : parts[p]->cell_nodes[e])
        if (owners.of_node[node] < 0) owners.of_node[node] = owners.of_cell[p][e];
  for (int& owner : owners.of_node) owner = std::max(owner, 0);  // nodes of virtual children only: constrained
  for (const std::vector<int>& nodes : together)
    for (const int node : nodes) owners.of_node[node] = owners.of_node[nodes.front()];
}

Owners partition(const ElasticSystem& system, int num_ranks, const std::vector<std::vector<int>>& together) {
  std::vector<Blocks> blocks;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  double total = 0;
  for (const BodyMesh* part : system.parts()) {
    blocks.push_back(make_blocks(*part));
    for (const Vec3& x : blocks.back().place) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    for (const double w : blocks.back().weight) total += w;
  }
  struct Item {
    std::uint64_t key;
    int part, block;
  };
  std::vector<Item> curve;
  const double scale = ((1 << bits) - 1) / std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  for (std::size_t p = 0; p < blocks.size(); ++p)
    for (std::size_t b = 0; b < blocks[p].place.size(); ++b) {
      const Vec3 x = scale * (blocks[p].place[b] - low);
      std::uint64_t key = 0;
      for (int d = 0; d < 3; ++d) key |= spread(static_cast<std::uint64_t>(x[d])) << d;
      curve.push_back({key, static_cast<int>(p), static_cast<int>(b)});
    }
  std::stable_sort(curve.begin(), curve.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
  std::vector<std::vector<int>> owner_of_block(blocks.size());
  for (std::size_t p = 0; p < blocks.size(); ++p) owner_of_block[p].resize(blocks[p].weight.size());
  double before = 0;
  for (const Item& item : curve) {
    const double weight = blocks[item.part].weight[item.block];
    owner_of_block[item.part][item.block] =
        std::min(num_ranks - 1, static_cast<int>((before + 0.5 * weight) / total * num_ranks));
    before += weight;
  }
  Owners owners;
  const std::vector<const BodyMesh*> parts = system.parts();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    owners.of_cell.emplace_back();
    for (const Index3& c : parts[p]->cut_cells->cells)
      owners.of_cell.back().push_back(owner_of_block[p][blocks[p].numbers.find(block_of(c))]);
  }
  own_nodes(system, together, owners);
  return owners;
}

}  // namespace cgcontact
