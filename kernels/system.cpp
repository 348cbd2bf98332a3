#include "kernels/system.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace cgcontact {
namespace {

template <class View, class T>
View to_view(const char* label, const std::vector<T>& values) {
  View view(std::string(label), values.size());
  auto host = Kokkos::create_mirror_view(view);
  for (std::size_t i = 0; i < values.size(); ++i) host(i) = values[i];
  Kokkos::deep_copy(view, host);
  return view;
}

}  // namespace

ElasticSystem make_elastic_system(const std::vector<const CutCells*>& bodies, const std::vector<Material>& materials,
                                  const Scales& scales, double ghost_penalty) {
  ElasticSystem system;
  system.ghost_penalty = ghost_penalty;
  system.supports.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    system.meshes.push_back(make_body_mesh(*bodies[b], materials[b], scales, system.num_nodes));
    system.num_nodes += system.meshes.back().num_nodes;
    system.matrices.push_back(make_cell_matrices(system.meshes.back()));
    system.ghosts.push_back(make_ghost_matrix(system.meshes.back(), ghost_penalty));
  }
  return system;
}

void add_support_terms(ElasticSystem& system, int body, const std::vector<SupportTerm>& terms) {
  const CutCells& cc = *system.meshes[body].cut_cells;
  auto host = Kokkos::create_mirror_view(system.matrices[body]);
  Kokkos::deep_copy(host, system.matrices[body]);
  for (const SupportTerm& t : terms) {
    const int cut = cc.cut_of_active[t.cell];
    if (cut < 0) throw std::logic_error("support point in an interior cell");
    double N[8], row[24];
    hex_shape(t.xi.data(), N);
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i) row[3 * a + i] = N[a] * t.direction[i];
    for (int r = 0; r < 24; ++r)
      for (int c = 0; c < 24; ++c) host(1 + cut, r, c) += t.stiffness * (row[r] * row[c]);
  }
  Kokkos::deep_copy(system.matrices[body], host);
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
  r.row_begin = to_view<IntView>("cgcontact::system::row_begin", begin);
  r.row_dof = to_view<IntView>("cgcontact::system::row_dof", dof);
  r.row_value = to_view<RealView>("cgcontact::system::row_value", value);
  r.dof_begin = to_view<IntView>("cgcontact::system::dof_begin", dof_begin);
  r.dof_list = to_view<IntView>("cgcontact::system::dof_list", dof_list);
  r.column_group = to_view<IntView>("cgcontact::system::column_group", column_group);
  r.column_value = to_view<RealView>("cgcontact::system::column_value", column_value);
  r.stiffness = RealView("cgcontact::system::stiffness", system.group_rows.size());
  r.scratch = RealView("cgcontact::system::scratch", system.group_rows.size());
}

void set_group_stiffness(ElasticSystem& system, const std::vector<double>& stiffness) {
  auto host = Kokkos::create_mirror_view(system.groups.stiffness);
  for (std::size_t g = 0; g < stiffness.size(); ++g) host(g) = stiffness[g];
  Kokkos::deep_copy(system.groups.stiffness, host);
}

}  // namespace cgcontact
