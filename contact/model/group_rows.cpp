#include "contact/model/group_rows.hpp"

#include <algorithm>
#include <tuple>

#include "contact/kernels/row_kernels.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {
namespace {

RowSide<MemSpace> side_of(const std::vector<BodyModel>& bodies, const ElasticSystem& system, int body) {
  using Host = Kokkos::View<const std::array<int, 8>*, Kokkos::HostSpace>;
  const std::vector<std::array<int, 8>>& nodes = system.meshes[body].cell_nodes;
  return {Kokkos::create_mirror_view_and_copy(MemSpace(), Host(nodes.data(), nodes.size())),
          bodies[body].cut_cells.grid.rotation};
}

CompressedGapRows<MemSpace> rows_of_pair(const ExecSpace& exec, const ContactPair& pair,
                                         const std::vector<BodyModel>& bodies, const ElasticSystem& system) {
  const int before = static_cast<int>(pair.points.first_place());
  std::vector<int> first_point{before};
  std::vector<double> area;
  for (const ContactGroup& group : pair.groups) {
    first_point.push_back(before + group.last_point);
    area.push_back(group.area);
  }
  return gap_rows(exec, copy_points<MemSpace>(pair.points.arrays()),
                  copy_to_view<IntView>("cgcontact::contact::first_point", first_point),
                  copy_to_view<RealView>("cgcontact::contact::area", area), side_of(bodies, system, pair.primary),
                  side_of(bodies, system, pair.secondary));
}

}  // namespace

std::vector<GroupRow> make_group_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                      const std::vector<BodyModel>& bodies, const ElasticSystem& system) {
  constexpr std::size_t most_copies = 3;
  std::size_t max_surfaces = 0;  // a family is a surface of a pair, along one direction
  for (const BodyModel& body : bodies) max_surfaces = std::max(max_surfaces, body.cut_cells.solid.surfaces().size());
  std::vector<GroupRow> rows;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ContactPair& pair = pairs[k];
    const CompressedGapRows<MemSpace> of_pair = rows_of_pair(exec, pair, bodies, system);
    const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.begin);
    const auto dof = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.dof);
    const auto value = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.value);
    for (std::size_t g = 0; g < pair.groups.size(); ++g) {
      const ContactGroup& group = pair.groups[g];
      GroupRow row;
      row.entries.reserve(begin(g + 1) - begin(g));
      for (int e = begin(g); e < begin(g + 1); ++e) row.entries.emplace_back(dof(e), value(e));
      std::tie(row.part, row.cell) = system.part_of(group.body, group.cell);
      const std::size_t copy = g / pair.num_pieces();
      row.family = static_cast<int>((k * most_copies + copy) * max_surfaces + group.surface);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace cgcontact
