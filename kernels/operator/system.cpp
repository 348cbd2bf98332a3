#include "kernels/operator/system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/sparse_rows.hpp"

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
