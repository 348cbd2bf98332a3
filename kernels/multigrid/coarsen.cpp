#include "kernels/multigrid/coarsen.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include "core/base/process/parallel.hpp"
#include "kernels/mesh/hanging_nodes.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/sparse_rows.hpp"

namespace cgcontact {
namespace {

Index3 parent(const Index3& c) { return {c[0] / 2, c[1] / 2, c[2] / 2}; }

/// Lagrange polynomials of the three Gauss points.
void lagrange(double x, double value[3]) {
  const double g = Gauss3::point[2];
  value[0] = x * (x - g) / (2 * g * g);
  value[1] = 1 - x * x / (g * g);
  value[2] = x * (x + g) / (2 * g * g);
}

/// The same for d and -d.
std::array<double, 3> unsigned_direction(const Vec3& d) {
  const double sign = d[0] < 0 || (d[0] == 0 && (d[1] < 0 || (d[1] == 0 && d[2] < 0))) ? -1 : 1;
  return {sign * d[0] + 0.0, sign * d[1] + 0.0, sign * d[2] + 0.0};
}

/// Stiffness over E h that holds bodies on coarse grids which contact alone holds. Iterations of all linear solves with
/// 0.001, 0.01, 0.03, 0.1, 1: balls_in_box 111, 58, 43, 39, 46; free_ball 52, 44, 47, 49, 60; pin 16, 10, 12, 14, 23
/// (tests/scenes).
constexpr double firm = 0.03;

/// Points of one cell and direction; more are merged.
constexpr int max_points = 27;

/// Contact rows per chunk of the parallel loop.
constexpr std::size_t rows_per_chunk = 32;

/// Points of one cell and direction become the 27 Gauss points with the same integrals of all products of shape
/// functions (some weights may be negative), so that coarse levels do not drag along all points of the finest.
void merge(std::vector<SupportTerm>& terms) {
  double weight[27] = {};
  for (const SupportTerm& t : terms) {
    double value[3][3];
    for (int d = 0; d < 3; ++d) lagrange(t.xi[d], value[d]);
    for (int q = 0; q < 27; ++q) weight[q] += t.stiffness * value[0][q / 9] * value[1][q / 3 % 3] * value[2][q % 3];
  }
  terms.resize(27);
  for (int q = 0; q < 27; ++q) {
    terms[q].xi = Vec3(Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]);
    terms[q].cell = terms[0].cell;
    terms[q].direction = terms[0].direction;
    terms[q].stiffness = weight[q];
  }
}

}  // namespace

namespace {

const Moments& moments_of(const CutCells& cells, int active) {
  const int cut = cells.cut_of_active[active];
  return cut < 0 ? full_cell_moments() : cells.moments[cut];
}

/// Children of a cell, -1 where there is none. Those of a quadtree also stand for the ones beside them across.
std::array<int, 8> children_of(const CutCells& fine, const Index3& c) {
  std::array<int, 8> children;
  const int across = fine.grid.is_quadtree() ? 1 << fine.grid.plane_strain : 0;
  for (int a = 0; a < 8; ++a) {
    const int at = a & ~across;
    children[a] = fine.find({2 * c[0] + (at & 1), 2 * c[1] + (at >> 1 & 1), 2 * c[2] + (at >> 2)});
  }
  return children;
}

/// The cells that are numbered: `fine` are those that they come from, one level below; `same` (or nullptr) those that
/// some of them are.
void fill_cells(const CutCells& fine, const CutCells* same, CutCells& coarse) {
  coarse.numbers.number();
  coarse.cells.reserve(coarse.numbers.size());
  coarse.numbers.each([&](const Index3& c) { coarse.cells.push_back(c); });
  coarse.cut_of_active.assign(coarse.cells.size(), -1);
  const auto as_before = [&](const Index3& c) { return same ? same->find(c) : -1; };
  for (std::size_t e = 0; e < coarse.cells.size(); ++e) {
    bool full = true;
    if (const int before = as_before(coarse.cells[e]); before >= 0) {
      full = same->cut_of_active[before] < 0;
    } else {
      for (const int child : children_of(fine, coarse.cells[e]))
        full = full && child >= 0 && fine.cut_of_active[child] < 0;
    }
    if (full && !coarse.grid.is_axisymmetric()) continue;
    coarse.cut_of_active[e] = static_cast<int>(coarse.active_of_cut.size());
    coarse.active_of_cut.push_back(static_cast<int>(e));
  }
  std::vector<Moments> all(coarse.active_of_cut.size());
  parallel_for("cgcontact::coarsen::moments", all.size(), grain_of_heavy, [&](const std::size_t cut) {
    const Index3& c = coarse.cells[coarse.active_of_cut[cut]];
    if (const int before = as_before(c); before >= 0) {
      all[cut] = moments_of(*same, before);
      return;
    }
    std::array<const Moments*, 8> children{};
    const std::array<int, 8> numbers = children_of(fine, c);
    for (int a = 0; a < 8; ++a)
      if (numbers[a] >= 0) children[a] = &moments_of(fine, numbers[a]);
    all[cut] = coarse_moments(children);
  });
  coarse.moments = MomentList(std::move(all));
}

/// A body of several levels by CellTree::coarsened.
CutCells coarse_tree_cells(const CutCells& fine) {
  const CellTree tree = fine.tree->coarsened();
  std::vector<CutCells> levels(fine.level_cells.size() - 1);
  for (int l = 0; l < static_cast<int>(levels.size()); ++l) {
    CutCells& level = levels[l];
    level.grid = fine.level_cells[l].grid;
    level.numbers = GridNumbers(level.grid.num_cells);
    for (const Index3& c : fine.level_cells[l].cells)
      if (tree.is_leaf(l, c)) level.numbers.insert(c);
    for (const Index3& c : fine.level_cells[l + 1].cells)
      if (tree.is_leaf(l, parent(c))) level.numbers.insert(parent(c));
    fill_cells(fine.level_cells[l + 1], &fine.level_cells[l], level);
  }
  if (levels.size() == 1) return std::move(levels.front());
  CutCells coarse;
  coarse.grid = fine.grid;
  coarse.grid.num_levels = static_cast<int>(levels.size());
  coarse.level_cells = std::move(levels);
  coarse.tree = std::make_shared<const CellTree>(tree);
  return coarse;
}

}  // namespace

CutCells coarse_cut_cells(const CutCells& fine) {
  if (!fine.level_cells.empty()) return coarse_tree_cells(fine);
  CutCells coarse;
  coarse.grid = fine.grid;
  coarse.grid.cell_size *= 2;
  for (int& n : coarse.grid.num_cells) n = (n + 1) / 2;
  coarse.numbers = GridNumbers(coarse.grid.num_cells);
  for (const Index3& c : fine.cells) coarse.numbers.insert(parent(c));
  fill_cells(fine, nullptr, coarse);
  return coarse;
}

bool is_coarsest(const CutCells& cells) {
  const Index3& n = cells.grid.num_cells;
  return cells.level_cells.empty() && std::max({n[0], n[1], n[2]}) <= 2;
}

CutCells next_cut_cells(const CutCells& fine) {
  if (!is_coarsest(fine)) return coarse_cut_cells(fine);
  CutCells same;
  same.grid = fine.grid;
  same.cells = fine.cells;
  same.numbers = fine.numbers;
  same.cut_of_active = fine.cut_of_active;
  same.active_of_cut = fine.active_of_cut;
  same.moments = fine.moments;
  return same;
}

CoarseCells::CoarseCells(const ElasticSystem& fine, const ElasticSystem& coarse)
    : fine_(fine.level_meshes()), coarse_(coarse.level_meshes()) {
  int first = 0;  // coarse level of the body
  for (std::size_t b = 0; b < fine.meshes.size(); ++b) {
    const int fine_levels = std::max<int>(1, static_cast<int>(fine.meshes[b].level_meshes.size()));
    const int coarse_levels = std::max<int>(1, static_cast<int>(coarse.meshes[b].level_meshes.size()));
    for (int p = 0; p < fine_levels; ++p) {
      const Grid& grid = fine_[own_.size()]->cut_cells->grid;
      own_.push_back(-1);
      larger_.push_back(-1);
      for (int q = first; q < first + coarse_levels; ++q) {
        const int steps = halvings(coarse_[q]->cut_cells->grid, grid);
        if (steps == 0) own_.back() = q;
        if (steps == 1) larger_.back() = q;
      }
    }
    first += coarse_levels;
  }
}

CoarseCells::CoarseCell CoarseCells::of(int level, int cell) const {
  const Index3& c = fine_[level]->cut_cells->cells[cell];
  if (larger_[level] >= 0)
    if (const int larger = coarse_[larger_[level]]->cut_cells->find(parent(c)); larger >= 0)
      return {larger_[level], larger, true};
  return {own_[level], own_[level] < 0 ? -1 : coarse_[own_[level]]->cut_cells->find(c), false};
}

namespace {

/// At most 27 terms per cell and direction.
std::vector<SupportTerm> merge_points(const std::vector<SupportTerm>& moved, std::size_t num_cells) {
  std::vector<int> begin(num_cells + 1, 0);
  for (const SupportTerm& t : moved) ++begin[t.cell + 1];
  for (std::size_t e = 1; e < begin.size(); ++e) begin[e] += begin[e - 1];
  std::vector<int> order(moved.size()), position(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < moved.size(); ++t) order[position[moved[t].cell]++] = static_cast<int>(t);
  // Merged terms come last; the others keep their order.
  std::vector<SupportTerm> merged, same;
  std::vector<char> taken(moved.size(), 0);
  for (std::size_t e = 0; e + 1 < begin.size(); ++e) {
    if (begin[e + 1] - begin[e] <= max_points) continue;
    const auto first = order.begin() + begin[e], last = order.begin() + begin[e + 1];
    const auto axis = [&](int t) { return unsigned_direction(moved[t].direction); };
    std::stable_sort(first, last, [&](int a, int b) { return axis(a) < axis(b); });
    for (auto from = first, to = first; from != last; from = to) {
      while (to != last && axis(*to) == axis(*from)) ++to;
      if (to - from <= max_points) continue;
      same.clear();
      for (auto t = from; t != to; ++t) {
        taken[*t] = 1;
        same.push_back(moved[*t]);
      }
      merge(same);
      merged.insert(merged.end(), same.begin(), same.end());
    }
  }
  std::vector<SupportTerm> result;
  result.reserve(moved.size() + merged.size());
  for (std::size_t t = 0; t < moved.size(); ++t)
    if (!taken[t]) result.push_back(moved[t]);
  result.insert(result.end(), merged.begin(), merged.end());
  return result;
}

}  // namespace

std::vector<std::vector<SupportTerm>> coarse_supports(const ElasticSystem& fine, const ElasticSystem& coarse,
                                                      bool firm_holds) {
  const CoarseCells cells(fine, coarse);
  const std::vector<const BodyMesh*> fine_levels = fine.level_meshes(), coarse_levels = coarse.level_meshes();
  std::vector<std::vector<SupportTerm>> moved(coarse_levels.size());
  std::vector<char> larger(coarse_levels.size(), 0);
  for (std::size_t p = 0; p < fine_levels.size(); ++p) {
    if (moved.size() == fine_levels.size()) moved[p].reserve(fine.supports[p].size());
    for (SupportTerm t : fine.supports[p]) {
      const Index3& c = fine_levels[p]->cut_cells->cells[t.cell];
      const CoarseCells::CoarseCell to_cell = cells.of(static_cast<int>(p), t.cell);
      if (to_cell.larger) {
        for (int d = 0; d < 3; ++d) t.xi[d] = 0.5 * (t.xi[d] + 2 * (c[d] % 2) - 1);
        t.stiffness *= 0.5;
        larger[to_cell.level] = 1;
      }
      t.cell = to_cell.cell;
      if (t.soft && firm_holds)
        t.stiffness = firm * coarse_levels[to_cell.level]->modulus * coarse_levels[to_cell.level]->h(t.cell);
      moved[to_cell.level].push_back(t);
    }
  }
  for (std::size_t q = 0; q < moved.size(); ++q)
    if (larger[q]) moved[q] = merge_points(moved[q], coarse_levels[q]->cut_cells->cells.size());
  return moved;
}

namespace {

/// Interpolates a node of one level from the nodes of cells of twice the size: position (in small cells) -> nodes of
/// the larger level.
SparseRow interpolate_node(const BodyMesh& larger, const Index3& position) {
  SparseRow row;
  for (int a = 0; a < 8; ++a) {
    Index3 p;
    double weight = 1;
    for (int d = 0; d < 3; ++d) {
      const int side = a >> d & 1, odd = position[d] & 1;
      p[d] = (position[d] + (side ? odd : 0)) >> 1;
      weight *= odd ? 0.5 : side ? 0 : 1;
    }
    if (weight > 0) row.emplace_back(larger.find_node(p), weight);
  }
  return row;
}

Transfer::Rows rows_to_views(const CompressedRows& rows) {
  return {copy_to_view<IntView>("cgcontact::coarsen::begin", rows.begin),
          copy_to_view<IntView>("cgcontact::coarsen::node", rows.number),
          copy_to_view<RealView>("cgcontact::coarsen::weight", rows.coefficient)};
}

/// Each free fine node from the coarse cell that one of its cells goes to.
Transfer make_row_transfer(const ElasticSystem& fine, const ElasticSystem& coarse) {
  const CoarseCells cells(fine, coarse);
  const std::vector<const BodyMesh*> fine_levels = fine.level_meshes(), coarse_levels = coarse.level_meshes();
  std::vector<SparseRow> rows(fine.num_nodes), columns(coarse.num_nodes);
  for (std::size_t p = 0; p < fine_levels.size(); ++p) {
    const BodyMesh& level = *fine_levels[p];
    for (int e = 0; e < static_cast<int>(level.cell_nodes.size()); ++e) {
      const CoarseCells::CoarseCell to_cell = cells.of(static_cast<int>(p), e);
      const BodyMesh& to = *coarse_levels[to_cell.level];
      for (const int node : level.cell_nodes[e]) {
        if (!rows[node].empty()) continue;
        if (!fine.constraint_of_node.empty() && fine.constraint_of_node[node] >= 0) continue;
        const Index3& at = level.nodes[node - level.first_node];
        rows[node] = to_cell.larger ? interpolate_node(to, at) : SparseRow{{to.find_node(at), 1.0}};
      }
    }
  }
  CompressedRows down, up;
  for (int n = 0; n < fine.num_nodes; ++n) {
    down.add(rows[n]);
    for (const auto& [node, weight] : rows[n]) columns[node].emplace_back(n, weight);
  }
  for (const SparseRow& column : columns) up.add(column);
  Transfer transfer;
  transfer.by_rows = true;
  transfer.parent_rows = rows_to_views(down);
  transfer.child_rows = rows_to_views(up);
  return transfer;
}

}  // namespace

Transfer make_transfer(const ElasticSystem& fine, const ElasticSystem& coarse) {
  // A body whose largest cells are all refined has several levels and no hanging node.
  if (!fine.constraints.empty() || fine.level_meshes().size() != fine.meshes.size())
    return make_row_transfer(fine, coarse);
  Transfer transfer;
  transfer.parents = decltype(transfer.parents)("cgcontact::coarsen::parents", fine.num_nodes);
  transfer.children = decltype(transfer.children)("cgcontact::coarsen::children", coarse.num_nodes);
  auto parents = Kokkos::create_mirror_view(transfer.parents);
  auto children = Kokkos::create_mirror_view(transfer.children);
  const std::vector<const BodyMesh*> fine_levels = fine.level_meshes(), coarse_levels = coarse.level_meshes();
  for (std::size_t b = 0; b < fine_levels.size(); ++b) {
    const BodyMesh &f = *fine_levels[b], &c = *coarse_levels[b];
    if (halvings(c.cut_cells->grid, f.cut_cells->grid) == 0) {
      for (int n = 0; n < f.num_nodes; ++n) {
        for (int a = 0; a < 8; ++a) parents(f.first_node + n, a) = c.first_node + n;
        for (int a = 0; a < 27; ++a) children(c.first_node + n, a) = a == 13 ? f.first_node + n : -1;
      }
      continue;
    }
    parallel_for("cgcontact::coarsen::parents", f.num_nodes, grain_of_medium, [&](const std::size_t n) {
      const Index3& x = f.nodes[n];
      const int along = x[0] % 2;  // parents along x follow each other, or are one
      for (int a = 0; a < 8; a += 2) {
        const Index3 p{x[0] / 2, (x[1] + (a >> 1 & 1)) / 2, (x[2] + (a >> 2)) / 2};
        parents(f.first_node + n, a) = c.find_node(p);
        parents(f.first_node + n, a + 1) = parents(f.first_node + n, a) + along;
      }
    });
    parallel_for("cgcontact::coarsen::children", c.num_nodes, grain_of_medium, [&](const std::size_t n) {
      const Index3& x = c.nodes[n];
      for (int row = 0; row < 9; ++row) {
        int numbers[3];
        f.node_numbers.find_row({2 * x[0] - 1, 2 * x[1] + row / 3 - 1, 2 * x[2] + row % 3 - 1}, 3, numbers);
        for (int i = 0; i < 3; ++i)
          children(c.first_node + n, 9 * i + row) = numbers[i] < 0 ? -1 : f.first_node + numbers[i];
      }
    });
  }
  Kokkos::deep_copy(transfer.parents, parents);
  Kokkos::deep_copy(transfer.children, children);
  return transfer;
}

namespace {

/// Numbers, each once.
class NumberSet {
 public:
  explicit NumberSet(int end) : seen_(end, 0) {}
  void add(int number) {
    if (!seen_[number]) list.push_back(number);
    seen_[number] = 1;
  }
  std::vector<int> list;

 private:
  std::vector<char> seen_;
};

std::vector<int> nodes_of_rows(const std::vector<GroupRow>& rows, int num_nodes) {
  NumberSet nodes(num_nodes);
  for (const GroupRow& row : rows)
    for (const auto& [dof, value] : row.entries) nodes.add(node_of_dof(dof));
  return std::move(nodes.list);
}

}  // namespace

RowCoarsening::RowCoarsening(const ElasticSystem& fine, const ElasticSystem& coarse, const Transfer& transfer,
                             const std::vector<GroupRow>& rows, const RowCoarsening* before)
    : row_of_node_(fine.num_nodes, -1) {
  find_members(fine, coarse, rows);
  const auto parents = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parents);
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parent_rows.begin);
  const auto node = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parent_rows.node);
  const auto weight = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), transfer.parent_rows.weight);
  for (const int n : before ? before->coarse_nodes_ : nodes_of_rows(rows, fine.num_nodes)) {
    row_of_node_[n] = static_cast<int>(begin_.size()) - 1;
    if (transfer.by_rows)
      for (int e = begin(n); e < begin(n + 1); ++e) parents_.emplace_back(node(e), weight(e));
    else
      for (int a = 0; a < 8; ++a) parents_.emplace_back(parents(n, a), 0.125);
    begin_.push_back(static_cast<int>(parents_.size()));
  }
  NumberSet nodes(coarse.num_nodes);  // constraints of rows are resolved: masters instead
  for (const auto& [parent, share] : parents_) {
    const int c = coarse.constraint_of_node.empty() ? -1 : coarse.constraint_of_node[parent];
    if (c < 0)
      nodes.add(parent);
    else
      for (const auto& [master, of_master] : coarse.constraints[c].masters) nodes.add(master);
  }
  coarse_nodes_ = std::move(nodes.list);
}

/// Finds the members of each coarse row: same level, coarse cell and family, in order of first appearance.
void RowCoarsening::find_members(const ElasticSystem& fine, const ElasticSystem& coarse,
                                 const std::vector<GroupRow>& rows) {
  const CoarseCells cells(fine, coarse);
  std::map<std::tuple<int, int, int>, int> index;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const CoarseCells::CoarseCell to_cell = cells.of(rows[r].level, rows[r].cell);
    factor_.push_back(to_cell.larger ? 0.5 : 1.0);
    const auto [entry, is_new] =
        index.emplace(std::make_tuple(to_cell.level, to_cell.cell, rows[r].family), static_cast<int>(members_.size()));
    if (is_new) {
      members_.emplace_back();
      coarse_rows_.push_back({{}, to_cell.level, to_cell.cell, rows[r].family});
    }
    members_[entry->second].push_back(static_cast<int>(r));
  }
}

RowCoarsening::Present RowCoarsening::update(const std::vector<GroupRow>& fine, const Present& present,
                                             const ElasticSystem& coarse, std::vector<GroupRow>& rows) {
  const bool first = share_.empty();
  std::vector<double> share(fine.size(), 0.0);
  Present result{std::vector<double>(members_.size(), 0.0), std::vector<double>(members_.size(), 0.0),
                 std::vector<char>(members_.size(), first)};
  if (first) rows = coarse_rows_;
  for (std::size_t c = 0; c < members_.size(); ++c) {
    for (const int r : members_[c]) {
      result.stiffness[c] += factor_[r] * present.stiffness[r];
      result.full_stiffness[c] += factor_[r] * present.full_stiffness[r];
    }
    const std::vector<double>& weight = result.stiffness[c] > 0 ? present.stiffness : present.full_stiffness;
    double sum = 0;
    for (const int r : members_[c]) sum += weight[r];
    for (const int r : members_[c]) {
      share[r] = weight[r] / sum;
      if (!first) result.changed[c] |= share[r] != share_[r] || (present.changed[r] && share[r] != 0);
    }
  }
  share_ = std::move(share);
  parallel_for("cgcontact::coarsen::rows", members_.size(), rows_per_chunk, [&](std::size_t c) {
    if (!result.changed[c]) return;
    rows[c].entries = merged(members_[c], fine, share_);
    if (!coarse.constraints.empty()) resolve_constraints(coarse, rows[c].entries);
  });
  return result;
}

std::vector<std::pair<int, double>> RowCoarsening::merged(const std::vector<int>& members,
                                                          const std::vector<GroupRow>& fine,
                                                          const std::vector<double>& share) const {
  std::vector<std::pair<int, double>> entries, result;
  for (const int r : members) {
    if (share[r] == 0) continue;
    for (const auto& [dof, value] : fine[r].entries) {
      const int row = row_of_node_[node_of_dof(dof)];
      if (row < 0) throw std::logic_error("coarsen: a contact row at a node without parents");
      for (int e = begin_[row]; e < begin_[row + 1]; ++e)
        entries.emplace_back(dof_of(parents_[e].first, component_of_dof(dof)), parents_[e].second * share[r] * value);
    }
  }
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [dof, value] : entries)
    if (!result.empty() && result.back().first == dof)
      result.back().second += value;
    else
      result.emplace_back(dof, value);
  return result;
}

}  // namespace cgcontact
