#include "core/drawing/sampled_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/base/process/parallel.hpp"

namespace cgcontact {

namespace {

/// Distances from a zone, in sizes of a block, below which it is not joined with others. The next one where too many
/// stay.
constexpr double nearness[] = {2, 1, 0.5, 0};
/// Levels of blocks above the largest cells.
constexpr int levels_above = 6;

using Key = std::uint64_t;

/// Packs a position: grids have fewer than 2^21 cells along an axis.
Key key_of(const Index3& c) {
  return static_cast<Key>(c[0]) | static_cast<Key>(c[1]) << 21 | static_cast<Key>(c[2]) << 42;
}

/// Returns the block that holds a position on the next larger level. Positions are not negative.
Index3 parent_of(const Index3& c, int flat_axis) {
  Index3 parent{c[0] >> 1, c[1] >> 1, c[2] >> 1};
  if (flat_axis >= 0) parent[flat_axis] = 0;
  return parent;
}

/// Cells that are drawn as one cube.
struct DrawnBlock {
  int level = 0;  ///< of a cell; below zero: larger than all cells
  Index3 position;
  std::array<int, 8> cell_of_corner;  ///< the active cell that has it, or is nearest to it
  double error = 0;
  unsigned char status = 0;
};

class Blocks {
 public:
  Blocks(const BodyFields& body, const std::vector<SceneBox>& zones, double near_zone)
      : body_(body),
        cells_(*body.cut_cells),
        zones_(zones),
        near_zone_(near_zone),
        flat_axis_(cells_.grid.plane_strain) {
    if (!cells_.grid.is_quadtree()) flat_axis_ = -1;
    for (int c = 0; c < static_cast<int>(cells_.cells.size()); ++c) {
      DrawnBlock block;
      block.level = cells_.level(c);
      block.position = cells_.cells[c];
      block.cell_of_corner.fill(c);
      if (!body.error_of_cell.empty()) block.error = stress_error(body, c);
      if (!body.patch_status.empty()) block.status = body.patch_status[c];
      waiting_[block.level].push_back(block);
    }
    count_ = cells_.cells.size();
  }

  /// Joins blocks, the smallest ones first, until there are few enough.
  std::vector<DrawnBlock> reduce(std::size_t most) {
    for (int level = cells_.num_levels() - 1; count_ > most && level > -levels_above; --level) join(level);
    for (auto& [level, blocks] : waiting_) done_.insert(done_.end(), blocks.begin(), blocks.end());
    return std::move(done_);
  }

 private:
  double size_of(int level) const { return cells_.grid.cell_size_of(0) * std::ldexp(1.0, -level); }

  bool is_near_zone(int level, const Index3& position) const {
    const double size = size_of(level);
    const Vec3 middle = cells_.grid.to_global(std::ldexp(1.0, -level) *
                                              (Vec3(position[0], position[1], position[2]) + Vec3::Constant(0.5)));
    return std::any_of(zones_.begin(), zones_.end(), [&](const SceneBox& zone) {
      const Vec3 outside = (zone.low - middle).cwiseMax(middle - zone.high).cwiseMax(0);
      return outside.norm() < near_zone_ * size;
    });
  }

  /// Makes those of a level blocks of the next larger one where all that the larger one holds may be joined.
  void join(int level) {
    std::vector<DrawnBlock> blocks = std::move(waiting_[level]);
    waiting_.erase(level);
    std::unordered_map<Key, std::vector<std::size_t>> families;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      families[key_of(parent_of(blocks[i].position, flat_axis_))].push_back(i);
    std::unordered_set<Key> divided;  // on the larger level: those that hold blocks which stay
    for (const Key key : divided_) {
      const Index3 position{static_cast<int>(key & 0x1fffff), static_cast<int>(key >> 21 & 0x1fffff),
                            static_cast<int>(key >> 42)};
      divided.insert(key_of(parent_of(position, flat_axis_)));
    }
    for (const auto& [key, members] : families) {
      const Index3 position = parent_of(blocks[members.front()].position, flat_axis_);
      if (divided.count(key) || is_near_zone(level - 1, position)) {
        for (const std::size_t i : members) done_.push_back(blocks[i]);
        divided.insert(key);
        continue;
      }
      waiting_[level - 1].push_back(joined(blocks, members, level - 1, position));
      count_ -= members.size() - 1;
    }
    divided_ = std::move(divided);
  }

  DrawnBlock joined(const std::vector<DrawnBlock>& blocks, const std::vector<std::size_t>& members, int level,
                    const Index3& position) const {
    DrawnBlock block;
    block.level = level;
    block.position = position;
    std::array<const DrawnBlock*, 8> child{};
    for (const std::size_t i : members) {
      const Index3& c = blocks[i].position;
      int octant = 0;
      for (int k = 0; k < 3; ++k)
        if (k != flat_axis_) octant |= (c[k] & 1) << k;
      child[octant] = &blocks[i];
      block.error = std::max(block.error, blocks[i].error);
      block.status = std::max(block.status, blocks[i].status);
    }
    for (int corner = 0; corner < 8; ++corner) {
      const int own = flat_axis_ >= 0 ? corner & ~(1 << flat_axis_) : corner;
      int nearest = -1, least = 4;  // bits in which the octants differ
      for (int octant = 0; octant < 8; ++octant)
        if (const int far = __builtin_popcount(own ^ octant); child[octant] && far < least) {
          least = far;
          nearest = octant;
        }
      block.cell_of_corner[corner] = child[nearest]->cell_of_corner[corner];
    }
    return block;
  }

  const BodyFields& body_;
  const CutCells& cells_;
  const std::vector<SceneBox>& zones_;
  const double near_zone_;
  int flat_axis_;
  std::map<int, std::vector<DrawnBlock>> waiting_;  ///< by level
  std::vector<DrawnBlock> done_;
  std::unordered_set<Key> divided_;  ///< on the level that comes next: positions that hold smaller blocks
  std::size_t count_ = 0;
};

/// Corners of all blocks, each once.
class Corners {
 public:
  Corners(const BodyFields& body, SampledCells& sampled)
      : body_(body), cells_(*body.cut_cells), finest_(cells_.num_levels() - 1), sampled_(sampled) {}

  void add(const DrawnBlock& block) {
    std::array<int, 8> corners;
    for (int c = 0; c < 8; ++c) {
      Index3 position = block.position;
      for (int k = 0; k < 3; ++k) {
        position[k] += c >> k & 1;
        position[k] <<= finest_ - block.level;
      }
      if (is_flat()) position[flat_axis()] = c >> flat_axis() & 1;
      const auto [found, is_new] = number_.try_emplace(key_of(position), static_cast<int>(positions_.size()));
      if (is_new) {
        positions_.push_back(position);
        cell_.push_back(block.cell_of_corner[c]);
      }
      corners[c] = found->second;
    }
    sampled_.blocks.push_back(corners);
    sampled_.cell.push_back(block.cell_of_corner[0]);
  }

  void set_values() {
    const std::size_t n = positions_.size();
    sampled_.position.resize(n);
    sampled_.displacement.assign(n, Vec3::Zero());
    if (body_.stress_recovered) sampled_.stress.resize(n);
    parallel_for("cgcontact::sampled_cells::values", n, grain_of_medium, [&](std::size_t i) {
      Vec3 x = std::ldexp(1.0, -finest_) * Vec3(positions_[i][0], positions_[i][1], positions_[i][2]);
      if (is_flat()) x[flat_axis()] = 0;
      sampled_.position[i] = cells_.grid.to_global(x);
      Vec3 xi = clamped_cell_coordinates(cells_, cell_[i], x);
      if (is_flat()) {
        xi[flat_axis()] = 2 * positions_[i][flat_axis()] - 1;
        sampled_.position[i][flat_axis()] += 0.5 * cells_.grid.thickness * xi[flat_axis()];
      }
      if (body_.displacement) sampled_.displacement[i] = body_.displacement(cell_[i], xi);
      if (body_.stress_recovered) sampled_.stress[i] = body_.stress_recovered(cell_[i], xi);
    });
  }

 private:
  bool is_flat() const { return cells_.grid.is_quadtree(); }
  int flat_axis() const { return cells_.grid.plane_strain; }

  const BodyFields& body_;
  const CutCells& cells_;
  int finest_;
  SampledCells& sampled_;
  std::unordered_map<Key, int> number_;
  std::vector<Index3> positions_;
  std::vector<int> cell_;
};

}  // namespace

SampledCells sample_cells(const BodyFields& body, const std::vector<SceneBox>& zones, std::size_t most) {
  std::vector<DrawnBlock> blocks;
  for (const double near_zone : nearness) {
    blocks = Blocks(body, zones, near_zone).reduce(most);
    if (blocks.size() <= most) break;
  }
  std::sort(blocks.begin(), blocks.end(),
            [](const DrawnBlock& a, const DrawnBlock& b) { return a.cell_of_corner[0] < b.cell_of_corner[0]; });
  SampledCells sampled;
  Corners corners(body, sampled);
  for (const DrawnBlock& block : blocks) {
    corners.add(block);
    const int cells_along = 1 << std::max(0, body.cut_cells->level(block.cell_of_corner[0]) - block.level);
    sampled.largest_block = std::max(sampled.largest_block, cells_along);
    if (!body.error_of_cell.empty()) sampled.stress_error.push_back(block.error);
    if (!body.patch_status.empty()) sampled.status.push_back(block.status);
  }
  corners.set_values();
  return sampled;
}

}  // namespace cgcontact
