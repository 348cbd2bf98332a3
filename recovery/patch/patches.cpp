#include "recovery/patch/patches.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/base/numbers/rounding.hpp"
#include "core/base/process/parallel.hpp"
#include "core/geometry/solid_middle.hpp"
#include "recovery/patch/patch_arrays.hpp"

namespace cgcontact {
namespace {

MonomialMoments monomial_moments(const Moments& m) {
  constexpr int n = moment_degree + 1;
  const auto L = [&](int i, int j, int k) { return m[(i * n + j) * n + k] / 8; };
  // xi^2 = (2 L_2 + 1) / 3; the cell's coordinate is xi / 2.
  const auto square = [](double l2, double l0) { return (2 * l2 + l0) / 3; };
  return {L(0, 0, 0),
          L(1, 0, 0) / 2,
          L(0, 1, 0) / 2,
          L(0, 0, 1) / 2,
          square(L(2, 0, 0), L(0, 0, 0)) / 4,
          square(L(0, 2, 0), L(0, 0, 0)) / 4,
          square(L(0, 0, 2), L(0, 0, 0)) / 4,
          L(1, 1, 0) / 4,
          L(0, 1, 1) / 4,
          L(1, 0, 1) / 4,
          L(1, 1, 1) / 8,
          square(L(2, 1, 0), L(0, 1, 0)) / 8,
          square(L(2, 0, 1), L(0, 0, 1)) / 8,
          square(L(1, 2, 0), L(1, 0, 0)) / 8,
          square(L(0, 2, 1), L(0, 0, 1)) / 8,
          square(L(1, 0, 2), L(1, 0, 0)) / 8,
          square(L(0, 1, 2), L(0, 1, 0)) / 8};
}

/// Active cells that a free node is a corner of.
class CornerCells {
 public:
  explicit CornerCells(const BodyMesh& mesh) : mesh_(mesh) {
    if (mesh.level_meshes.empty()) return;
    begin_.assign(mesh.num_nodes + 1, 0);
    each_corner([&](int node, int) { ++begin_[node + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    cells_.resize(begin_.back());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    each_corner([&](int node, int cell) { cells_[next[node]++] = cell; });
  }

  /// Ascending; returns their number.
  int around(int node, int cells[8]) const {
    int count = 0;
    if (!begin_.empty()) {
      for (int i = begin_[node]; i < begin_[node + 1]; ++i) cells[count++] = cells_[i];
      return count;
    }
    const Index3& position = mesh_.nodes[node];
    for (int a = 0; a < 8; ++a) {
      const int c = mesh_.cut_cells->find(
          {position[0] - 1 + (a & 1), position[1] - 1 + (a >> 1 & 1), position[2] - 1 + (a >> 2)});
      if (c >= 0) cells[count++] = c;
    }
    return count;
  }

  double volume_around(int node) const {
    int cells[8];
    const int count = around(node, cells);
    double volume = 0;
    for (int i = 0; i < count; ++i) volume += mesh_.cut_cells->volume_fraction(cells[i]);
    return volume;
  }

 private:
  /// use(free node, cell) for all corners that are free nodes or copies of one, cell by cell; in plane strain those of
  /// the lower side, whose copies are opposite.
  template <class Use>
  void each_corner(const Use& use) const {
    const int upper = mesh_.is_one_layer() ? 1 << mesh_.cut_cells->grid.plane_strain : 0;
    for (std::size_t cell = 0; cell < mesh_.cell_nodes.size(); ++cell)
      for (int a = 0; a < 8; ++a) {
        if (a & upper) continue;
        each_master(mesh_, mesh_.cell_nodes[cell][a] - mesh_.first_node, [&](int node, double weight) {
          if (weight == 1) use(node, static_cast<int>(cell));
        });
      }
  }

  const BodyMesh& mesh_;
  std::vector<int> begin_, cells_;  ///< by node; empty: one level
};

/// Joins a patch of too little volume with the patch of the fullest neighbouring node; with one cell of
/// material the condition of the patch's mass matrix stays below 370 (degree 1). True if anything was added.
bool grow_patch(const BodyMesh& mesh, const CornerCells& corner_cells, const Vec3& middle, int n, double min_volume,
                double have, std::vector<int>& patch) {
  const CutCells& cc = *mesh.cut_cells;
  const double unit = unit_of(mesh, n);
  const Vec3 own = mesh.node_position(n);
  bool grown = false;
  for (int step = 0; step < 3 && have < min_volume; ++step) {
    double best = -1;
    int anchor = -1;
    for (int c : patch)
      for (int node : mesh.cell_nodes[c])
        each_master(mesh, node - mesh.first_node, [&](int m, double) {
          const Vec3 position = mesh.node_position(m);
          // Takes the nearest one of equals; of those the one towards the middle of the body, in its mirror image as
          // well.
          const double away = ((position - middle).norm() - (own - middle).norm()) / unit;
          const double score = corner_cells.volume_around(m) - 1e-3 * ((position - own).norm() / unit) - 1e-5 * away;
          if (score > best * (1 + rounding)) best = score, anchor = m;
        });
    int around[8];
    const int count = corner_cells.around(anchor, around);
    const std::size_t before = patch.size();
    for (int i = 0; i < count; ++i)
      if (std::find(patch.begin(), patch.end(), around[i]) == patch.end()) {
        patch.push_back(around[i]);
        have += cc.volume_fraction(around[i]);
      }
    if (patch.size() == before) break;
    grown = true;
  }
  std::sort(patch.begin(), patch.end());
  return grown;
}

void factor_masses(const BodyMesh& mesh, PatchSet& set) {
  set.factor_of_patch.assign(mesh.num_nodes, -1);
  int count = 0;
  for (int n = 0; n < mesh.num_nodes; ++n)
    if (!set.full[n] && set.begin[n] < set.begin[n + 1]) set.factor_of_patch[n] = count++;
  set.factors.resize(count);
  const auto arrays = host_arrays(mesh, set);
  parallel_for("cgcontact::patches::factors", mesh.num_nodes, grain_of_light, [&](std::size_t n) {
    if (set.factor_of_patch[n] < 0) return;
    const double centre[3] = {double(mesh.nodes[n][0]), double(mesh.nodes[n][1]), double(mesh.nodes[n][2])};
    double m[num_terms][num_terms];
    gather_mass(arrays, &set.cells[set.begin[n]], set.begin[n + 1] - set.begin[n], centre, m,
                level_of(mesh, static_cast<int>(n)));
    const double volume = m[0][0];
    const bool regular = cholesky(m);
    auto& factor = set.factors[set.factor_of_patch[n]];
    for (int i = 0, entry = 0; i < num_terms; ++i)
      for (int j = 0; j <= i; ++j) factor[entry++] = m[i][j];
    if (!regular) factor[0] = -volume;
  });
}

/// Patches of a range of nodes.
struct PatchRange {
  std::vector<int> size, cells;
};

PatchRange patches_of_nodes(const BodyMesh& mesh, const CornerCells& corner_cells, double min_volume,
                            const Subset& nodes, std::size_t begin, std::size_t end, PatchSet& set) {
  const CutCells& cc = *mesh.cut_cells;
  const Vec3 middle = middle_of(cc.solid);
  PatchRange range;
  std::vector<int> patch;
  for (std::size_t n = begin; n < end; ++n) {
    if (!mesh.is_free(static_cast<int>(n)) || nodes.row(static_cast<int>(n)) < 0) {
      range.size.push_back(0);
      continue;
    }
    int around[8];
    const int count = corner_cells.around(static_cast<int>(n), around);
    patch.assign(around, around + count);
    double volume = 0;
    bool full = count == 8;
    for (int c : patch) {
      volume += cc.volume_fraction(c);
      full = full && cc.cut_of_active[c] < 0 && cc.level(c) == cc.level(patch.front());
    }
    set.full[n] = full;
    if (volume < min_volume)
      set.grown[n] = grow_patch(mesh, corner_cells, middle, static_cast<int>(n), min_volume, volume, patch);
    range.size.push_back(static_cast<int>(patch.size()));
    range.cells.insert(range.cells.end(), patch.begin(), patch.end());
  }
  return range;
}

}  // namespace

void mark_nodes(const BodyMesh& mesh, int cell, std::vector<char>& marked) {
  for (const int corner : mesh.cell_nodes[cell]) {
    const int node = corner - mesh.first_node;
    marked[node] = 1;
    each_master(mesh, node, [&](int master, double) { marked[master] = 1; });
  }
}

PatchSet make_patches(const BodyMesh& mesh, double min_volume) {
  return make_patches(mesh, min_volume, Subset(mesh.num_nodes));
}

PatchSet make_patches(const BodyMesh& mesh, double min_volume, const Subset& nodes) {
  const CutCells& cc = *mesh.cut_cells;
  PatchSet set;
  set.grown.assign(mesh.num_nodes, 0);
  set.full.assign(mesh.num_nodes, 0);
  const CornerCells corner_cells(mesh);
  std::vector<PatchRange> ranges(num_chunks(mesh.num_nodes, grain_of_light));
  parallel_chunks("cgcontact::patches::grow", mesh.num_nodes, grain_of_light,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    ranges[chunk] = patches_of_nodes(mesh, corner_cells, min_volume, nodes, begin, end, set);
                  });
  std::size_t total = 0;
  for (const PatchRange& range : ranges) total += range.cells.size();
  set.begin.reserve(mesh.num_nodes + 1);
  set.begin.push_back(0);
  set.cells.reserve(total);
  for (PatchRange& range : ranges) {
    for (int size : range.size) set.begin.push_back(set.begin.back() + size);
    set.cells.insert(set.cells.end(), range.cells.begin(), range.cells.end());
    range = {};
  }
  set.moments.resize(1 + cc.moments.size());
  set.moments[0] = monomial_moments(full_cell_moments());
  for (std::size_t c = 0; c < cc.moments.size(); ++c) set.moments[1 + c] = monomial_moments(cc.moments[c]);
  factor_masses(mesh, set);
  return set;
}

std::vector<PatchSet> make_patches(const std::vector<BodyMesh>& meshes, double min_volume) {
  std::vector<PatchSet> sets;
  for (const BodyMesh& mesh : meshes) sets.push_back(make_patches(mesh, min_volume));
  return sets;
}

}  // namespace cgcontact
