#include "kernels/operator/system.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {
ElasticSystem make_elastic_system(const std::vector<const CutCells*>& bodies, const std::vector<Material>& materials,
                                  const Scales& scales, double ghost_penalty) {
  ElasticSystem system;
  system.ghost_penalty = ghost_penalty;
  system.materials = materials;
  system.scales = scales;
  system.supports.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    system.meshes.push_back(make_body_mesh(*bodies[b], materials[b], scales, system.num_nodes));
    system.dofs = DofMap(static_cast<long long>(system.num_nodes) + system.meshes.back().num_nodes);
    system.num_nodes = system.dofs.num_nodes();
  }
  return system;
}

void add_support_terms(ElasticSystem& system, int body, const std::vector<SupportTerm>& terms) {
  for (const SupportTerm& t : terms)
    if (system.meshes[body].cut_cells->cut_of_active[t.cell] < 0)
      throw std::logic_error("support point in an interior cell");
  system.supports[body].insert(system.supports[body].end(), terms.begin(), terms.end());
}

void set_group_rows(ElasticSystem& system, std::vector<GroupRow> rows) {
  system.group_rows = std::move(rows);
  std::vector<int> begin{0}, dof, dof_begin{0}, dof_list, column_group;
  std::vector<double> value, column_value;
  std::map<int, std::vector<std::pair<int, double>>> columns;
  for (std::size_t g = 0; g < system.group_rows.size(); ++g) {
    for (const auto& [d, v] : system.group_rows[g].entries) {
      dof.push_back(d);
      value.push_back(v);
      columns[d].emplace_back(static_cast<int>(g), v);
    }
    begin.push_back(static_cast<int>(dof.size()));
  }
  for (const auto& [d, entries] : columns) {
    dof_list.push_back(d);
    for (const auto& [g, v] : entries) {
      column_group.push_back(g);
      column_value.push_back(v);
    }
    dof_begin.push_back(static_cast<int>(column_group.size()));
  }
  GroupRows& r = system.groups;
  r.row_begin = copy_to_view<IntView>("cgcontact::system::row_begin", begin);
  r.row_dof = copy_to_view<IntView>("cgcontact::system::row_dof", dof);
  r.row_value = copy_to_view<RealView>("cgcontact::system::row_value", value);
  r.dof_begin = copy_to_view<IntView>("cgcontact::system::dof_begin", dof_begin);
  r.dof_list = copy_to_view<IntView>("cgcontact::system::dof_list", dof_list);
  r.column_group = copy_to_view<IntView>("cgcontact::system::column_group", column_group);
  r.column_value = copy_to_view<RealView>("cgcontact::system::column_value", column_value);
  r.stiffness = RealView("cgcontact::system::stiffness", system.group_rows.size());
  r.scratch = RealView("cgcontact::system::scratch", system.group_rows.size());
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

}  // namespace cgcontact
