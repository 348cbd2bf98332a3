#include "contact/solve/forces/contact_arrays.hpp"

#include <algorithm>
#include <numeric>

#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/interpolate.hpp"

namespace cgcontact {
namespace {

HostContactPoints points_of_all(const OuterProblem& problem) {
  std::vector<ContactPoints*> points;
  for (ContactPair& pair : problem.pairs) points.push_back(&pair.points);
  return ContactPoints::join(points);
}

/// Host copy of a view, written by `fill(host)` and copied back.
template <class View, class Fill>
void fill_view(const View& view, const Fill& fill) {
  const auto host = Kokkos::create_mirror_view(view);
  fill(host);
  Kokkos::deep_copy(view, host);
}

template <class Vectors>
void set_row(const Vectors& to, std::size_t i, const Vec3& from) {
  for (int d = 0; d < 3; ++d) to(i, d) = from[d];
}

}  // namespace

ContactGroupArrays<MemSpace> make_group_arrays(const OuterProblem& problem) {
  const HostContactPoints points = points_of_all(problem);
  std::vector<int> first{0};
  int points_before = 0;
  for (const ContactPair& pair : problem.pairs) {
    for (const ContactGroup& group : pair.groups) first.push_back(points_before + group.last_point);
    points_before += static_cast<int>(pair.points.size());
  }
  first.resize(problem.system.group_rows.size() + 1, first.back());  // rows of friction have no points of their own
  ContactGroupArrays<MemSpace> groups(first.size() - 1, points.size());
  groups.first_point = copy_to_view<IntView>("cgcontact::contact::first_point", first);
  groups.weight = Kokkos::create_mirror_view_and_copy(MemSpace(), points.weight);
  groups.active = Kokkos::create_mirror_view_and_copy(MemSpace(), points.active);
  groups.lagged_unit = problem.scales.stress;
  return groups;
}

void take_state(const OuterProblem& problem, const SmallZones& zones, const ContactGroupArrays<MemSpace>& groups) {
  const auto law = Kokkos::create_mirror_view(groups.law);
  const auto gap = Kokkos::create_mirror_view(groups.initial_gap);
  const auto in_zone = Kokkos::create_mirror_view(groups.in_zone);
  const auto zone = Kokkos::create_mirror_view(groups.zone);
  std::size_t g = 0;
  for (const ContactPair& pair : problem.pairs)
    for (const ContactGroup& group : pair.groups) {
      law(g) = pair.law(group);
      gap(g) = group.initial_gap;
      in_zone(g) = zones.has(g) ? 1 : 0;
      zone(g) = zones.force(g);
      ++g;
    }
  Kokkos::deep_copy(groups.law, law);
  Kokkos::deep_copy(groups.initial_gap, gap);
  Kokkos::deep_copy(groups.in_zone, in_zone);
  Kokkos::deep_copy(groups.zone, zone);
  Kokkos::deep_copy(groups.active, points_of_all(problem).active);
}

void give_state(const OuterProblem& problem, const ContactGroupArrays<MemSpace>& groups) {
  Kokkos::deep_copy(points_of_all(problem).active, groups.active);
}

SupportArrays<MemSpace> make_support_arrays(const OuterProblem& problem) {
  const std::vector<SupportPoint>& points = problem.supports;
  SupportArrays<MemSpace> supports(points.size());
  supports.lagged_unit = problem.scales.stress;
  const auto each = [&](const auto& view, const auto& set) {
    fill_view(view, [&](const auto& host) {
      for (std::size_t s = 0; s < points.size(); ++s) set(host, s, points[s]);
    });
  };
  each(supports.nodes, [&](const auto& to, std::size_t s, const SupportPoint& p) {
    for (int a = 0; a < 8; ++a) to(s, a) = problem.system.meshes[p.body].cell_nodes[p.cell][a];
  });
  each(supports.xi, [](const auto& to, std::size_t s, const SupportPoint& p) { set_row(to, s, p.xi); });
  each(supports.local_direction, [&](const auto& to, std::size_t s, const SupportPoint& p) {
    set_row(to, s, problem.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction);
  });
  each(supports.weight, [](const auto& to, std::size_t s, const SupportPoint& p) { to(s) = p.weight; });
  each(supports.k, [&](const auto& to, std::size_t s, const SupportPoint& p) {
    to(s) = support_stiffness(problem.scene, problem.bodies[p.body], p);
  });
  return supports;
}

void take_values(const OuterProblem& problem, const SupportArrays<MemSpace>& supports) {
  fill_view(supports.value, [&](const auto& host) {
    for (std::size_t s = 0; s < problem.supports.size(); ++s) host(s) = problem.supports[s].value;
  });
}

DirectionArrays<MemSpace> support_directions(const OuterProblem& problem) {
  const std::vector<SupportPoint>& points = problem.supports;
  const DirectionArrays<MemSpace> arrays(points.size());
  fill_view(arrays.body, [&](const auto& host) {
    for (std::size_t s = 0; s < points.size(); ++s) host(s) = points[s].body;
  });
  fill_view(arrays.x, [&](const auto& host) {
    for (std::size_t s = 0; s < points.size(); ++s)
      set_row(host, s, global_position(problem.bodies[points[s].body].cut_cells, points[s].cell, points[s].xi));
  });
  fill_view(arrays.direction, [&](const auto& host) {
    for (std::size_t s = 0; s < points.size(); ++s) set_row(host, s, points[s].direction);
  });
  return arrays;
}

DirectionArrays<MemSpace> row_directions(const OuterProblem& problem) {
  const auto dofs = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), problem.system.groups.dof_list);
  const DirectionArrays<MemSpace> arrays(dofs.extent(0));
  const std::vector<BodyMesh>& meshes = problem.system.meshes;
  const auto body_of = [&](int node) {
    std::size_t b = 0;
    while (node >= meshes[b].first_node + meshes[b].num_nodes) ++b;
    return b;
  };
  const auto body = Kokkos::create_mirror_view(arrays.body);
  const auto x = Kokkos::create_mirror_view(arrays.x);
  const auto direction = Kokkos::create_mirror_view(arrays.direction);
  for (std::size_t d = 0; d < dofs.extent(0); ++d) {
    const int node = node_of_dof(dofs(d));
    const std::size_t b = body_of(node);
    const Grid& grid = meshes[b].cut_cells->grid;
    body(d) = static_cast<int>(b);
    set_row(x, d, grid.to_global(meshes[b].node_position(node - meshes[b].first_node)));
    set_row(direction, d, grid.rotation.col(component_of_dof(dofs(d))));
  }
  Kokkos::deep_copy(arrays.body, body);
  Kokkos::deep_copy(arrays.x, x);
  Kokkos::deep_copy(arrays.direction, direction);
  return arrays;
}

IntView indices_of_entries(const GroupRows& rows) {
  const auto dofs = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), rows.dof_list);
  const auto row_dof = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), rows.row_dof);
  std::vector<int> indices(row_dof.extent(0));
  for (std::size_t e = 0; e < indices.size(); ++e)
    indices[e] =
        static_cast<int>(std::lower_bound(dofs.data(), dofs.data() + dofs.extent(0), row_dof(e)) - dofs.data());
  return copy_to_view<IntView>("cgcontact::contact::entry_place", indices);
}

TouchedNodes<MemSpace> make_touched_nodes(const OuterProblem& problem) {
  std::vector<int> index(problem.system.num_nodes, -1), node;
  const auto touch = [&](int n) {
    if (index[n] >= 0) return;
    index[n] = static_cast<int>(node.size());
    node.push_back(n);
  };
  const auto each_support = [&](const auto& use) {
    for (std::size_t s = 0; s < problem.supports.size(); ++s)
      if (const SupportPoint& p = problem.supports[s]; !p.implied)
        for (int a = 0; a < 8; ++a) use(static_cast<int>(s), problem.system.meshes[p.body].cell_nodes[p.cell][a], a);
  };
  const std::vector<GroupRow>& rows = problem.system.group_rows;
  each_support([&](int, int n, int) { touch(n); });
  for (const GroupRow& row : rows)
    for (const auto& [dof, value] : row.entries) touch(node_of_dof(dof));
  std::vector<int> support_begin(node.size() + 1, 0), group_begin(dofs_per_node * node.size() + 1, 0);
  const auto dof_index = [&](int dof) { return dof_of(index[node_of_dof(dof)], component_of_dof(dof)); };
  each_support([&](int, int n, int) { ++support_begin[index[n] + 1]; });
  for (const GroupRow& row : rows)
    for (const auto& [dof, value] : row.entries) ++group_begin[dof_index(dof) + 1];
  std::partial_sum(support_begin.begin(), support_begin.end(), support_begin.begin());
  std::partial_sum(group_begin.begin(), group_begin.end(), group_begin.begin());
  std::vector<int> support_corner(support_begin.back()), group(group_begin.back());
  std::vector<double> coefficient(group.size());
  std::vector<int> next(support_begin);
  each_support([&](int s, int n, int a) { support_corner[next[index[n]]++] = 8 * s + a; });
  next = group_begin;
  for (std::size_t g = 0; g < rows.size(); ++g)
    for (const auto& [dof, value] : rows[g].entries) {
      group[next[dof_index(dof)]] = static_cast<int>(g);
      coefficient[next[dof_index(dof)]++] = value;
    }
  TouchedNodes<MemSpace> touched;
  touched.node = copy_to_view<IntView>("cgcontact::contact::touched", node);
  touched.support_begin = copy_to_view<IntView>("cgcontact::contact::support_begin", support_begin);
  touched.support_corner = copy_to_view<IntView>("cgcontact::contact::support_corner", support_corner);
  touched.group_begin = copy_to_view<IntView>("cgcontact::contact::group_begin", group_begin);
  touched.group = copy_to_view<IntView>("cgcontact::contact::group", group);
  touched.coefficient = copy_to_view<RealView>("cgcontact::contact::coefficient", coefficient);
  return touched;
}

}  // namespace cgcontact
