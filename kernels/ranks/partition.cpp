#include "kernels/ranks/partition.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>

namespace cgcontact {
namespace {

/// Weight of a cut cell relative to an interior one: its own forces, those of the full cells beside it, its ghost faces
/// and its blocks in the smoother. In a linear solve it takes 10 times as long with AVX2 (two_solids_3d, n = 56).
constexpr double weight_of_cut_cell = 10;

/// Divisions that are tried, and largest over mean of the work with which one is good enough.
constexpr int max_attempts = 6;
constexpr double balanced = 1.03;

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

/// Blocks of one level with the weight of their cells.
struct Blocks {
  GridNumbers numbers;
  std::vector<Vec3> position;  ///< m, global axes
  std::vector<double> weight;
};

double weight_of(const CutCells& cells, std::size_t e) { return cells.cut_of_active[e] < 0 ? 1 : weight_of_cut_cell; }

Blocks make_blocks(const BodyMesh& level) {
  const CutCells& cells = *level.cut_cells;
  const Index3& n = cells.grid.num_cells;
  Blocks blocks;
  blocks.numbers = GridNumbers({n[0] / block + 1, n[1] / block + 1, n[2] / block + 1});
  for (const Index3& c : cells.cells) blocks.numbers.insert(block_of(c));
  blocks.numbers.number();
  blocks.weight.assign(blocks.numbers.size(), 0.0);
  for (std::size_t e = 0; e < cells.cells.size(); ++e)
    blocks.weight[blocks.numbers.find(block_of(cells.cells[e]))] += weight_of(cells, e);
  blocks.numbers.each([&](const Index3& b) {
    blocks.position.push_back(cells.grid.to_global(block * (Vec3(b[0], b[1], b[2]) + Vec3::Constant(0.5))));
  });
  return blocks;
}

/// Block on the curve.
struct Item {
  std::uint64_t key;
  int level, block;
};

std::vector<Item> curve_through(const std::vector<Blocks>& blocks) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Blocks& of_level : blocks)
    for (const Vec3& x : of_level.position) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
  std::vector<Item> curve;
  const double scale = ((1 << bits) - 1) / std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  for (std::size_t p = 0; p < blocks.size(); ++p)
    for (std::size_t b = 0; b < blocks[p].position.size(); ++b) {
      const Vec3 x = scale * (blocks[p].position[b] - low);
      std::uint64_t key = 0;
      for (int d = 0; d < 3; ++d) key |= spread(static_cast<std::uint64_t>(x[d])) << d;
      curve.push_back({key, static_cast<int>(p), static_cast<int>(b)});
    }
  std::stable_sort(curve.begin(), curve.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
  return curve;
}

/// Returns the rank of each block of each level; share: of the whole weight, of each rank.
std::vector<std::vector<int>> divide(const std::vector<Item>& curve, const std::vector<Blocks>& blocks,
                                     const std::vector<double>& share) {
  std::vector<std::vector<int>> ranks;
  double total = 0;
  for (const Blocks& of_level : blocks) {
    ranks.emplace_back(of_level.weight.size());
    for (const double weight : of_level.weight) total += weight;
  }
  double before = 0, end = share[0];
  std::size_t rank = 0;
  for (const Item& item : curve) {
    const double weight = blocks[item.level].weight[item.block] / total;
    while (rank + 1 < share.size() && before + 0.5 * weight >= end) end += share[++rank];
    ranks[item.level][item.block] = static_cast<int>(rank);
    before += weight;
  }
  return ranks;
}

Owners owners_of_cells(const ElasticSystem& system, const std::vector<Blocks>& blocks,
                       const std::vector<std::vector<int>>& owner_of_block) {
  Owners owners;
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t p = 0; p < levels.size(); ++p) {
    owners.of_cell.emplace_back();
    for (const Index3& c : levels[p]->cut_cells->cells)
      owners.of_cell.back().push_back(owner_of_block[p][blocks[p].numbers.find(block_of(c))]);
  }
  return owners;
}

/// Weight of the cells around the nodes of each rank; interior ones by their share of nodes.
std::vector<double> work_of_ranks(const ElasticSystem& system, const Owners& owners, int num_ranks) {
  std::vector<double> work(num_ranks, 0.0);
  for (const BodyMesh* level : system.level_meshes())
    for (std::size_t e = 0; e < level->cell_nodes.size(); ++e) {
      std::array<int, 8> ranks;
      for (int a = 0; a < 8; ++a) ranks[a] = owners.of_node[level->cell_nodes[e][a]];
      if (level->cut_cells->cut_of_active[e] < 0) {
        for (const int rank : ranks) work[rank] += 1.0 / 8;
        continue;
      }
      std::sort(ranks.begin(), ranks.end());
      for (int a = 0; a < 8; ++a)
        if (a == 0 || ranks[a] != ranks[a - 1]) work[ranks[a]] += weight_of_cut_cell;
    }
  return work;
}

}  // namespace

void own_nodes(const ElasticSystem& system, const std::vector<std::vector<int>>& together, Owners& owners) {
  owners.of_node.assign(system.num_nodes, -1);
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t p = 0; p < levels.size(); ++p)
    for (std::size_t e = 0; e < levels[p]->cell_nodes.size(); ++e)
      for (const int node : levels[p]->cell_nodes[e])
        if (owners.of_node[node] < 0) owners.of_node[node] = owners.of_cell[p][e];
  for (int& owner : owners.of_node) owner = std::max(owner, 0);  // nodes of virtual children only: constrained
  for (const std::vector<int>& nodes : together)
    for (const int node : nodes) owners.of_node[node] = owners.of_node[nodes.front()];
}

Owners partition(const ElasticSystem& system, int num_ranks, const std::vector<std::vector<int>>& together) {
  std::vector<Blocks> blocks;
  for (const BodyMesh* level : system.level_meshes()) blocks.push_back(make_blocks(*level));
  const std::vector<Item> curve = curve_through(blocks);
  // Cells at borders are computed by several ranks: ranks that have more of them get less of the curve.
  std::vector<double> share(num_ranks, 1.0 / num_ranks);
  Owners best;
  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    Owners owners = owners_of_cells(system, blocks, divide(curve, blocks, share));
    own_nodes(system, together, owners);
    const std::vector<double> work = work_of_ranks(system, owners, num_ranks);
    const double most = *std::max_element(work.begin(), work.end());
    const double mean = std::accumulate(work.begin(), work.end(), 0.0) / num_ranks;
    if (most < least) {
      least = most;
      best = std::move(owners);
    }
    if (most <= balanced * mean) break;
    for (int r = 0; r < num_ranks; ++r)
      if (work[r] > 0) share[r] *= mean / work[r];
    const double sum = std::accumulate(share.begin(), share.end(), 0.0);
    for (double& of_rank : share) of_rank /= sum;
  }
  return best;
}

}  // namespace cgcontact
