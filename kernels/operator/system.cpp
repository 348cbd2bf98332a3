#include "kernels/operator/system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "kernels/mesh/halo.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/sparse_rows.hpp"

namespace cgcontact {
std::vector<const BodyMesh*> ElasticSystem::level_meshes() const {
  std::vector<const BodyMesh*> all;
  for (const BodyMesh& mesh : meshes) {
    if (mesh.level_meshes.empty()) all.push_back(&mesh);
    for (const BodyMesh& level : mesh.level_meshes) all.push_back(&level);
  }
  return all;
}

std::pair<int, int> ElasticSystem::locate_cell(int body, int cell) const {
  int level = 0;
  for (int b = 0; b < body; ++b) level += std::max<int>(1, static_cast<int>(meshes[b].level_meshes.size()));
  if (meshes[body].level_meshes.empty()) return {level, cell};
  const CutCells& cells = *meshes[body].cut_cells;
  return {level + cells.level(cell), cell - cells.first_of_level[cells.level(cell)]};
}

int ElasticSystem::num_free_dofs() const {
  int sum = 0;
  for (const BodyMesh& mesh : meshes) sum += mesh.num_free_dofs();
  return sum;
}

bool ElasticSystem::is_zero(int dof) const { return std::binary_search(zero_dofs.begin(), zero_dofs.end(), dof); }

bool ElasticSystem::needs(int node) const { return !dofs.halo() || dofs.halo()->needs(node); }

bool ElasticSystem::needs_cell(const BodyMesh& level, int cell) const {
  const Halo* halo = dofs.halo();
  return !halo || std::any_of(level.cell_nodes[cell].begin(), level.cell_nodes[cell].end(),
                              [&](const int node) { return halo->needs(node); });
}

namespace {

/// Adds those of a body; the lists of a coarse body of several levels are those of its levels.
void add_zero_dofs(const BodyMesh& mesh, std::vector<int>& zero_dofs) {
  if (!mesh.is_one_layer()) return;
  if (mesh.nodes.empty())
    for (const BodyMesh& level : mesh.level_meshes) add_zero_dofs(level, zero_dofs);
  for (int n = 0; n < static_cast<int>(mesh.nodes.size()); ++n)
    for (int i = 0; i < dofs_per_node; ++i)
      if (mesh.is_zero(n, i)) zero_dofs.push_back(dof_of(mesh.first_node + n, i));
}

}  // namespace

ElasticSystem make_elastic_system(const std::vector<const CutCells*>& bodies, const std::vector<Material>& materials,
                                  const Scales& scales, double ghost_penalty) {
  ElasticSystem system;
  system.ghost_penalty = ghost_penalty;
  system.materials = materials;
  system.scales = scales;
  long long num_nodes = 0;
  system.meshes.reserve(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    system.meshes.push_back(make_body_mesh(*bodies[b], materials[b], scales, system.num_nodes));
    num_nodes += system.meshes.back().num_nodes;
    system.num_nodes = DofMap(num_nodes).num_nodes();  // checked
    const std::vector<NodeConstraint>& own = system.meshes.back().constraints;
    system.constraints.insert(system.constraints.end(), own.begin(), own.end());
  }
  for (const BodyMesh& mesh : system.meshes) add_zero_dofs(mesh, system.zero_dofs);
  system.dofs = DofMap(num_nodes, system.constraints, system.zero_dofs);
  if (!system.constraints.empty()) system.constraint_of_node.assign(system.num_nodes, -1);
  for (std::size_t c = 0; c < system.constraints.size(); ++c)
    system.constraint_of_node[system.constraints[c].node] = static_cast<int>(c);
  system.supports.resize(system.level_meshes().size());
  return system;
}

void resolve_constraints(const ElasticSystem& system, std::vector<std::pair<int, double>>& entries) {
  std::vector<std::pair<int, double>> resolved;
  for (const auto& [dof, value] : entries) {
    if (system.is_zero(dof)) continue;
    const int node = node_of_dof(dof), component = component_of_dof(dof);
    const int c = system.constraint_of_node.empty() ? -1 : system.constraint_of_node[node];
    if (c < 0) {
      resolved.emplace_back(dof, value);
      continue;
    }
    for (const auto& [master, weight] : system.constraints[c].masters)
      resolved.emplace_back(dof_of(master, component), weight * value);
  }
  std::stable_sort(resolved.begin(), resolved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  entries.clear();
  for (const auto& [dof, value] : resolved)
    if (!entries.empty() && entries.back().first == dof)
      entries.back().second += value;
    else
      entries.emplace_back(dof, value);
}

void add_support_terms(ElasticSystem& system, int body, const std::vector<SupportTerm>& terms) {
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  std::vector<std::size_t> count(levels.size(), 0);
  for (const SupportTerm& t : terms) ++count[system.locate_cell(body, t.cell).first];
  for (std::size_t p = 0; p < levels.size(); ++p) system.supports[p].reserve(system.supports[p].size() + count[p]);
  for (SupportTerm t : terms) {
    const auto [level, cell] = system.locate_cell(body, t.cell);
    t.cell = cell;
    if (levels[level]->cut_cells->cut_of_active[cell] < 0) throw std::logic_error("support point in an interior cell");
    system.supports[level].push_back(t);
  }
}

void set_group_rows(ElasticSystem& system, std::vector<GroupRow> rows) {
  system.group_rows = std::move(rows);
  if (!system.constraints.empty())
    for (GroupRow& row : system.group_rows) resolve_constraints(system, row.entries);
  compress_group_rows(system);
}

void compress_group_rows(ElasticSystem& system) {
  const auto [rows_of_groups, rows_of_dofs] = compress_rows(
      system.group_rows.size(), [&](std::size_t g) -> const SparseRow& { return system.group_rows[g].entries; },
      [](std::size_t g) { return static_cast<int>(g); });
  GroupRows& r = system.groups;
  r.row_begin = copy_to_view<IntView>("cgcontact::system::row_begin", rows_of_groups.begin);
  r.row_dof = copy_to_view<IntView>("cgcontact::system::row_dof", rows_of_groups.number);
  r.row_value = copy_to_view<RealView>("cgcontact::system::row_value", rows_of_groups.coefficient);
  r.dof_begin = copy_to_view<IntView>("cgcontact::system::dof_begin", rows_of_dofs.rows.begin);
  r.dof_list = copy_to_view<IntView>("cgcontact::system::dof_list", rows_of_dofs.column);
  r.column_group = copy_to_view<IntView>("cgcontact::system::column_group", rows_of_dofs.rows.number);
  r.column_value = copy_to_view<RealView>("cgcontact::system::column_value", rows_of_dofs.rows.coefficient);
  r.stiffness = RealView("cgcontact::system::stiffness", system.group_rows.size());
  r.scratch = RealView("cgcontact::system::scratch", system.group_rows.size());
  set_group_coupling(system, {});
}

std::vector<double> group_stiffness(const ElasticSystem& system) {
  auto host = Kokkos::create_mirror_view(system.groups.stiffness);
  Kokkos::deep_copy(host, system.groups.stiffness);
  return {host.data(), host.data() + host.extent(0)};
}

bool changed_much(const std::vector<double>& before, const std::vector<double>& now) {
  double change = 0, sum = 0;
  for (std::size_t g = 0; g < now.size(); ++g) {
    sum += now[g];
    change += std::abs(now[g] - before[g]);
  }
  return change > 0.1 * sum;
}

void set_group_stiffness(ElasticSystem& system, const std::vector<double>& stiffness) {
  auto host = Kokkos::create_mirror_view(system.groups.stiffness);
  for (std::size_t g = 0; g < stiffness.size(); ++g) host(g) = stiffness[g];
  Kokkos::deep_copy(system.groups.stiffness, host);
}

void set_group_coupling(ElasticSystem& system, const std::vector<double>& coupling) {
  system.groups.coupled_row = IntView();
  system.groups.coupling = RealView();
  if (std::all_of(coupling.begin(), coupling.end(), [](double c) { return c == 0; })) return;
  std::vector<int> row;
  for (const GroupRow& r : system.group_rows) row.push_back(r.coupled);
  system.groups.coupled_row = copy_to_view<IntView>("cgcontact::system::coupled_row", row);
  system.groups.coupling = copy_to_view<RealView>("cgcontact::system::coupling", coupling);
}

}  // namespace cgcontact
