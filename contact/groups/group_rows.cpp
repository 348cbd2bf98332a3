#include "contact/groups/group_rows.hpp"

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

/// Directions along which the points of a pair separate.
using Directions = std::vector<Vec3>;

CompressedGapRows<MemSpace> rows_of_pair(const ExecSpace& exec, const ContactPair& pair,
                                         const std::vector<BodyModel>& bodies, const ElasticSystem& system,
                                         const Directions& directions = {}) {
  const int before = static_cast<int>(pair.points.first_index());
  std::vector<int> first_point{before};
  std::vector<double> area;
  for (const ContactGroup& group : pair.groups) {
    first_point.push_back(before + group.last_point);
    area.push_back(group.area);
  }
  ContactPointArrays<MemSpace> points = copy_points<MemSpace>(pair.points.arrays());
  if (!directions.empty()) {
    points.direction = decltype(points.direction)("cgcontact::contact::tangents", points.size());
    const auto host = Kokkos::create_mirror_view(points.direction);
    for (std::size_t q = 0; q < directions.size(); ++q)
      for (int d = 0; d < 3; ++d) host(before + q, d) = directions[q][d];
    Kokkos::deep_copy(points.direction, host);
  }
  return gap_rows(exec, points, copy_to_view<IntView>("cgcontact::contact::first_point", first_point),
                  copy_to_view<RealView>("cgcontact::contact::area", area), side_of(bodies, system, pair.primary),
                  side_of(bodies, system, pair.secondary));
}

constexpr std::size_t max_copies = 3;

/// Rows of a pair, without their family.
std::vector<GroupRow> host_rows(const ContactPair& pair, const CompressedGapRows<MemSpace>& of_pair,
                                const ElasticSystem& system) {
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.begin);
  const auto dof = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.dof);
  const auto value = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), of_pair.value);
  std::vector<GroupRow> rows(pair.groups.size());
  for (std::size_t g = 0; g < rows.size(); ++g) {
    GroupRow& row = rows[g];
    row.entries.reserve(begin(g + 1) - begin(g));
    for (int e = begin(g); e < begin(g + 1); ++e) row.entries.emplace_back(dof(e), value(e));
    std::tie(row.level, row.cell) = system.locate_cell(pair.groups[g].body, pair.groups[g].cell);
  }
  return rows;
}

/// Numbers the rows that may be merged on coarser grids: those of a surface of a pair, along one direction.
class Families {
 public:
  explicit Families(const std::vector<BodyModel>& bodies) {
    for (const BodyModel& body : bodies)
      max_surfaces_ = std::max(max_surfaces_, body.cut_cells.solid.surfaces().size());
  }
  int operator()(std::size_t pair, std::size_t copy, int surface) const {
    return static_cast<int>((pair * max_copies + copy) * max_surfaces_ + surface);
  }

 private:
  std::size_t max_surfaces_ = 0;
};

}  // namespace

std::vector<GroupRow> make_group_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                      const std::vector<BodyModel>& bodies, const ElasticSystem& system) {
  const Families family(bodies);
  std::vector<GroupRow> rows;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ContactPair& pair = pairs[k];
    std::vector<GroupRow> of_pair = host_rows(pair, rows_of_pair(exec, pair, bodies, system), system);
    for (std::size_t g = 0; g < of_pair.size(); ++g) {
      of_pair[g].family = family(k, g / pair.num_surface_groups(), pair.groups[g].surface);
      rows.push_back(std::move(of_pair[g]));
    }
  }
  return rows;
}

std::vector<GroupRow> make_tangent_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                        const std::vector<BodyModel>& bodies, const ElasticSystem& system) {
  const Families family(bodies);
  std::vector<GroupRow> rows;
  int first_group = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ContactPair& pair = pairs[k];
    std::vector<std::vector<GroupRow>> along;
    for (int i = 0; i < pair.num_tangents; ++i) {
      Directions tangents;
      for (std::size_t q = 0; q < pair.points.size(); ++q) tangents.push_back(pair.tangents(q)[i]);
      along.push_back(host_rows(pair, rows_of_pair(exec, pair, bodies, system, tangents), system));
    }
    for (std::size_t g = 0; g < pair.groups.size(); ++g)
      for (std::size_t i = 0; i < along.size(); ++i) {
        along[i][g].family = family(k, 1 + i, pair.groups[g].surface);
        along[i][g].coupled = first_group + static_cast<int>(g);
        rows.push_back(std::move(along[i][g]));
      }
    first_group += static_cast<int>(pair.groups.size());
  }
  return rows;
}

void match_tangent_rows(const std::vector<ContactPair>& pairs, std::size_t first, std::vector<GroupRow>& rows) {
  using Entries = std::vector<std::pair<int, double>>;
  const auto with_dofs_of = [](const Entries& own, const Entries& other) {
    Entries all = own;
    for (const auto& [dof, value] : other) all.emplace_back(dof, 0.0);
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    all.erase(std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
              all.end());
    return all;
  };
  std::size_t row = first;
  for (const ContactPair& pair : pairs)
    for (std::size_t g = 0; g < pair.groups.size(); ++g, row += pair.num_tangents) {
      if (pair.num_tangents < 2) continue;
      const Entries second = with_dofs_of(rows[row + 1].entries, rows[row].entries);
      rows[row].entries = with_dofs_of(rows[row].entries, rows[row + 1].entries);
      rows[row + 1].entries = second;
    }
}

}  // namespace cgcontact
