#include "kernels/ranks/rank_share.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/base/process/ranks.hpp"
#include "kernels/mesh/hanging_nodes.hpp"
#include "kernels/mesh/row_sums.hpp"

namespace cgcontact {
namespace {

bool is_constrained(const ElasticSystem& system, int node) {
  return !system.constraint_of_node.empty() && system.constraint_of_node[node] >= 0;
}

/// Some cells of a grid of one level.
CutCells restricted(const CutCells& cells, const std::vector<char>& keep) {
  CutCells kept_cells;
  kept_cells.grid = cells.grid;
  kept_cells.numbers = GridNumbers(cells.grid.num_cells);
  std::vector<int> chosen;
  kept_cells.cells.reserve(std::count_if(keep.begin(), keep.end(), [](char kept) { return kept != 0; }));
  kept_cells.cut_of_active.reserve(kept_cells.cells.capacity());
  for (std::size_t e = 0; e < cells.cells.size(); ++e) {
    if (!keep[e]) continue;
    kept_cells.numbers.insert(cells.cells[e]);
    const int cut = cells.cut_of_active[e];
    kept_cells.cut_of_active.push_back(cut < 0 ? -1 : static_cast<int>(chosen.size()));
    if (cut >= 0) {
      kept_cells.active_of_cut.push_back(static_cast<int>(kept_cells.cells.size()));
      chosen.push_back(cut);
    }
    kept_cells.cells.push_back(cells.cells[e]);
  }
  kept_cells.numbers.number();
  kept_cells.moments = cells.moments.chosen(std::move(chosen));
  return kept_cells;
}

/// Choice of a rank's cells and of the nodes that they use.
class CellChoice {
 public:
  CellChoice(const ElasticSystem& whole, const std::vector<char>& needed, const std::vector<char>& more)
      : whole_(whole), levels_(whole.level_meshes()), needed_(needed), used(more) {
    for (const BodyMesh* level : levels_) keep.emplace_back(level->cell_nodes.size(), 0);
    for (std::size_t p = 0; p < levels_.size(); ++p) choose_around_needed(p);
    if (!whole.constraints.empty()) use_masters();
    keep_cells_of_used();
  }

 private:
  bool is_needed(std::size_t p, int cell) const {
    const auto& nodes = levels_[p]->cell_nodes[cell];
    return std::any_of(nodes.begin(), nodes.end(), [&](const int node) { return needed_[node]; });
  }

  void choose(std::size_t p, int cell) {
    keep[p][cell] = 1;
    for (const int node : levels_[p]->cell_nodes[cell]) used[node] = 1;
  }

  void choose_around_needed(std::size_t p) {
    const BodyMesh& level = *levels_[p];
    const CutCells& cells = *level.cut_cells;
    for (int e = 0; e < static_cast<int>(cells.cells.size()); ++e) {
      const bool is_own = is_needed(p, e);
      if (is_own) choose(p, e);
      for (int d = 0; d < 3; ++d) {
        Index3 next = cells.cells[e];
        ++next[d];
        const int f = cells.find(next);
        if (f < 0 || !is_ghost_face(level, e, f) || !(is_own || is_needed(p, f))) continue;
        choose(p, e);
        choose(p, f);
      }
    }
    for (const LevelFace& face : level.level_faces) choose_level_face(p, face);
  }

  /// The smaller cell, and the larger one that the virtual child lies in.
  void choose_level_face(std::size_t p, const LevelFace& face) {
    const BodyMesh& level = *levels_[p];
    Index3 child = face.lower;
    if (child == level.cut_cells->cells[face.cell]) ++child[face.direction];
    bool is_own = is_needed(p, face.cell);
    std::vector<int> nodes;
    for (int a = 0; a < 8; ++a) {
      nodes.push_back(level.find_node({child[0] + (a & 1), child[1] + (a >> 1 & 1), child[2] + (a >> 2)}));
      is_own = is_own || needed_[nodes.back()];
    }
    if (!is_own) return;
    choose(p, face.cell);
    for (const int node : nodes) used[node] = 1;
    for (std::size_t q = first_level_of_body(p); q < p; ++q) {
      const int steps = halvings(levels_[q]->cut_cells->grid, level.cut_cells->grid);
      if (steps > 1) continue;
      const int larger = levels_[q]->cut_cells->find({child[0] >> steps, child[1] >> steps, child[2] >> steps});
      if (larger >= 0) choose(q, larger);
    }
  }

  std::size_t first_level_of_body(std::size_t p) const {
    std::size_t first = 0;
    for (const BodyMesh& mesh : whole_.meshes) {
      const std::size_t count = std::max<std::size_t>(1, mesh.level_meshes.size());
      if (p < first + count) return first;
      first += count;
    }
    return p;
  }

  void use_masters() {
    for (const NodeConstraint& c : whole_.constraints) {
      if (!used[c.node]) continue;
      for (const auto& [master, weight] : c.masters) used[master] = 1;
    }
  }

  /// A node comes with a cell: if it is used and none of its cells is kept, the first one is.
  void keep_cells_of_used() {
    std::vector<char> has_cell(whole_.num_nodes, 0);
    for (std::size_t p = 0; p < levels_.size(); ++p)
      for (std::size_t e = 0; e < keep[p].size(); ++e)
        if (keep[p][e])
          for (const int node : levels_[p]->cell_nodes[e]) has_cell[node] = 1;
    for (std::size_t p = 0; p < levels_.size(); ++p)
      for (std::size_t e = 0; e < keep[p].size(); ++e) {
        const auto& nodes = levels_[p]->cell_nodes[e];
        if (keep[p][e] ||
            std::none_of(nodes.begin(), nodes.end(), [&](const int node) { return used[node] && !has_cell[node]; }))
          continue;
        keep[p][e] = 1;
        for (const int node : nodes) has_cell[node] = 1;
      }
  }

  const ElasticSystem& whole_;
  std::vector<const BodyMesh*> levels_;
  const std::vector<char>& needed_;

 public:
  std::vector<std::vector<char>> keep;  ///< of each level and cell
  std::vector<char> used;               ///< of each node
};

}  // namespace

std::vector<char> needed_nodes(const ElasticSystem& whole, const Owners& owners, int rank) {
  std::vector<char> needed(whole.num_nodes);
  for (int n = 0; n < whole.num_nodes; ++n) needed[n] = owners.of_node[n] == rank && !is_constrained(whole, n);
  for (const NodeConstraint& c : whole.constraints)
    for (const auto& [master, weight] : c.masters)
      if (owners.of_node[master] == rank) needed[c.node] = 1;
  return needed;
}

bool RankShare::owns(int whole_node) const { return owners_.of_node[whole_node] == this_rank(); }

RankShare::RankShare(const ElasticSystem& whole, Owners owners, const std::vector<char>& more, const Halo::Comm& comm)
    : owners_(std::move(owners)) {
  const std::vector<char> needed = needed_nodes(whole, owners_, this_rank());
  const CellChoice choice(whole, needed, more);
  system_.ghost_penalty = whole.ghost_penalty;
  system_.materials = whole.materials;
  system_.scales = whole.scales;
  cells_.reserve(whole.meshes.size());
  std::size_t level = 0;
  for (std::size_t b = 0; b < whole.meshes.size(); ++b) {
    const BodyMesh& mesh = whole.meshes[b];
    if (mesh.level_meshes.empty()) {
      cells_.push_back(restricted(*mesh.cut_cells, choice.keep[level++]));
    } else {
      cells_.emplace_back();
      cells_.back().grid = mesh.cut_cells->grid;
      for (const BodyMesh& of_level : mesh.level_meshes)
        cells_.back().level_cells.push_back(restricted(*of_level.cut_cells, choice.keep[level++]));
    }
    system_.meshes.push_back(
        number_body_mesh(cells_[b], whole.materials[b], whole.scales, system_.num_nodes, !mesh.nodes.empty()));
    system_.num_nodes += system_.meshes.back().num_nodes;
  }
  // Both numberings go by body, level and position: numbers of the whole system ascend.
  local_of_whole_.assign(whole.num_nodes, -1);
  whole_nodes_.reserve(system_.num_nodes);
  const std::vector<const BodyMesh*> levels = system_.level_meshes(), whole_levels = whole.level_meshes();
  for (std::size_t p = 0; p < levels.size(); ++p)
    for (int n = 0; n < levels[p]->num_nodes; ++n) {
      const int in_whole = whole_levels[p]->find_node(levels[p]->nodes[n]);
      if (in_whole < 0) throw std::logic_error("a node of a rank is none of the whole system");
      local_of_whole_[in_whole] = static_cast<int>(whole_nodes_.size());
      whole_nodes_.push_back(in_whole);
    }
  std::vector<Halo::Role> roles;
  std::vector<int> node_owners;
  std::vector<char> local_needed;
  roles.reserve(system_.num_nodes);
  node_owners.reserve(system_.num_nodes);
  local_needed.reserve(system_.num_nodes);
  if (!whole.constraints.empty()) system_.constraint_of_node.assign(system_.num_nodes, -1);
  for (int n = 0; n < system_.num_nodes; ++n) {
    const int in_whole = whole_nodes_[n];
    node_owners.push_back(owners_.of_node[in_whole]);
    local_needed.push_back(needed[in_whole]);
    roles.push_back(!choice.used[in_whole]                     ? Halo::Role::unused
                    : owners_.of_node[in_whole] == this_rank() ? Halo::Role::owned
                                                               : Halo::Role::ghost);
    if (!is_constrained(whole, in_whole)) continue;
    roles.back() = choice.used[in_whole] ? Halo::Role::constrained : Halo::Role::unused;
    if (!choice.used[in_whole]) continue;  // else its masters are, too
    NodeConstraint constraint{n, {}};
    for (const auto& [master, weight] : whole.constraints[whole.constraint_of_node[in_whole]].masters)
      constraint.masters.emplace_back(local(master), weight);
    system_.constraint_of_node[n] = static_cast<int>(system_.constraints.size());
    system_.constraints.push_back(std::move(constraint));
  }
  for (const int dof : whole.zero_dofs)
    if (const int n = local_of_whole_[node_of_dof(dof)]; n >= 0)
      system_.zero_dofs.push_back(dof_of(n, component_of_dof(dof)));
  system_.dofs = DofMap(system_.num_nodes, system_.constraints, system_.zero_dofs,
                        std::make_shared<const Halo>(comm, whole_nodes_, node_owners, roles, std::move(local_needed)));
  system_.supports.resize(levels.size());
  for (std::size_t p = 0; p < levels.size(); ++p)
    for (SupportTerm term : whole.supports[p]) {
      if (!choice.keep[p][term.cell]) continue;
      term.cell = levels[p]->cut_cells->find(whole_levels[p]->cut_cells->cells[term.cell]);
      system_.supports[p].push_back(term);
    }
  for (std::vector<SupportTerm>& terms : system_.supports) terms.shrink_to_fit();
  order_.reserve(whole.num_nodes - whole.constraints.size());
  for (int rank = 0; rank < num_ranks(); ++rank)
    for (int n = 0; n < whole.num_nodes; ++n)
      if (owners_.of_node[n] == rank && !is_constrained(whole, n)) order_.push_back(n);
  owners_.of_cell = std::vector<std::vector<int>>();
}

void RankShare::record_counts() const {
  const Halo& halo = *system_.dofs.halo();
  RankWork& work = work_of_rank();
  work.unknowns = dofs_per_node * static_cast<double>(halo.num_owned());
  work.ghosts = dofs_per_node * static_cast<double>(halo.num_ghosts());
  work.cut_cells = 0;
  for (const BodyMesh* level : system_.level_meshes())
    for (const int cell : level->cut_cells->active_of_cut) work.cut_cells += system_.needs_cell(*level, cell);
}

void RankShare::set_groups(const std::vector<GroupRow>& rows, const std::vector<double>& stiffness, bool same_rows) {
  if (!same_rows) {
    set_group_rows(system_, own_entries(rows));
    set_group_sums();
  }
  set_group_stiffness(system_, stiffness);
}

void RankShare::take_coupling(const ElasticSystem& whole) {
  system_.groups.coupled_row = whole.groups.coupled_row;
  system_.groups.coupling = whole.groups.coupling;
}

void RankShare::set_group_sums() {
  std::vector<int> own, shared;
  for (std::size_t g = 0; g < system_.group_rows.size(); ++g)
    if (const GroupRow& row = system_.group_rows[g];
        !row.entries.empty() || (row.coupled >= 0 && !system_.group_rows[row.coupled].entries.empty()))
      own.push_back(static_cast<int>(g));
  const std::vector<RowPart> parts = parts_of_shared_rows(own);
  system_.group_sums.reset();
  if (parts.empty()) return;
  for (const RowPart& part : parts)
    if (part.rank == this_rank()) shared.push_back(part.row);
  system_.group_sums = std::make_shared<const RowSums>(system_.dofs.halo()->comm(), parts, shared);
}

std::vector<GroupRow> RankShare::own_entries(const std::vector<GroupRow>& rows) const {
  std::vector<GroupRow> own;
  own.reserve(rows.size());
  for (const GroupRow& row : rows) {
    own.push_back({{}, row.level, row.cell, row.family, row.coupled});
    for (const auto& [dof, value] : row.entries)
      if (owns(node_of_dof(dof)))
        own.back().entries.emplace_back(dof_of(local(node_of_dof(dof)), component_of_dof(dof)), value);
  }
  return own;
}

template <class View>
void RankShare::copy_to_local(const View& whole, const View& local) const {
  const auto from = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole);
  auto to = Kokkos::create_mirror_view(local);
  for (std::size_t n = 0; n < whole_nodes_.size(); ++n)
    for (int i = 0; i < dofs_per_node; ++i) to(dof_offset(n, i)) = from(dof_offset(whole_nodes_[n], i));
  Kokkos::deep_copy(local, to);
}

template <class View>
void RankShare::gather_whole(const View& local, const View& whole) const {
  using Real = typename View::non_const_value_type;
  const auto from = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), local);
  const auto owned = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), system_.dofs.halo()->owned());
  std::vector<Real> own(dof_offset(owned.extent(0)));
  for (std::size_t n = 0; n < owned.extent(0); ++n)
    for (int i = 0; i < dofs_per_node; ++i) own[dof_offset(n, i)] = from(dof_offset(owned(n), i));
  const std::vector<Real> all = gather(own);
  auto to = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), whole);
  for (std::size_t n = 0; n < order_.size(); ++n)
    for (int i = 0; i < dofs_per_node; ++i) to(dof_offset(order_[n], i)) = all[dof_offset(n, i)];
  Kokkos::deep_copy(whole, to);
}

using SingleView = Kokkos::View<float*, MemSpace>;
void RankShare::to_local(const RealView& whole, const RealView& local) const { copy_to_local(whole, local); }
void RankShare::to_local(const SingleView& whole, const SingleView& local) const { copy_to_local(whole, local); }
void RankShare::to_whole(const RealView& local, const RealView& whole) const { gather_whole(local, whole); }
void RankShare::to_whole(const SingleView& local, const SingleView& whole) const { gather_whole(local, whole); }

void RankShare::drop_cells() { cgcontact::drop_cells(cells_, system_); }

namespace {

void keep_grid(CutCells& cells) {
  CutCells grid;
  grid.grid = cells.grid;
  for (CutCells& level : cells.level_cells) keep_grid(level);
  grid.level_cells = std::move(cells.level_cells);
  cells = std::move(grid);
}

/// v = {} would keep its memory.
template <class Container>
void free_memory(Container& container) {
  container = Container();
}

void keep_positions(BodyMesh& mesh) {
  free_memory(mesh.cell_nodes);
  free_memory(mesh.node_numbers);
  free_memory(mesh.level_faces);
  for (BodyMesh& level : mesh.level_meshes) keep_positions(level);
}

}  // namespace

void drop_cells(std::vector<CutCells>& bodies, ElasticSystem& system) {
  for (CutCells& body : bodies) keep_grid(body);
  for (BodyMesh& mesh : system.meshes) keep_positions(mesh);
  for (std::vector<SupportTerm>& terms : system.supports) free_memory(terms);
}

}  // namespace cgcontact
