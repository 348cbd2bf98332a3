#include "recovery/spr/interior_fit.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/base/process/parallel.hpp"
#include "recovery/spr/spr_kernels.hpp"

namespace cgcontact {
InteriorFit::InteriorFit(const BodyMesh& mesh, const RealView& u, bool corrected,
                         std::function<Vec3(int node)> divergence)
    : mesh_(mesh),
      u_(Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u)),
      corrected_(corrected),
      divergence_(std::move(divergence)) {}

/// Ascending.
void InteriorFit::find_cells(int node, int cells[8]) const {
  const Index3& position = mesh_.nodes[node];
  for (int a = 0; a < 8; ++a) {
    cells[a] = mesh_.cut_cells->find(
        level_of(mesh_, node), {position[0] - 1 + (a & 1), position[1] - 1 + (a >> 1 & 1), position[2] - 1 + (a >> 2)});
    if (cells[a] < 0 || mesh_.cut_cells->cut_of_active[cells[a]] >= 0)
      throw std::logic_error("a node at the boundary has no interior fit");
  }
}

InteriorFit::Integrals InteriorFit::integrals_of(int cell) const {
  double corner[8][3], integrals[6][num_terms];
  corner_values(mesh_.cell_nodes[cell], u_, corner);
  full_cell_stress_integrals(mesh_.law, mesh_.stress_factor(cell), corner, integrals);
  Integrals result;
  std::copy_n(integrals[0], result.size(), result.begin());
  return result;
}

template <class IntegralsOf>
void InteriorFit::fit(int node, const IntegralsOf& integrals_of_cell, double* a) const {
  fit_full_patch(integrals_of_cell, a);
  if (!corrected_) return;
  const Vec3 divergence = divergence_ ? divergence_(node) : Vec3(Vec3::Zero());
  put_in_equilibrium(divergence.data(), a);
}

void InteriorFit::at(int node, double* a) const {
  int cells[8];
  find_cells(node, cells);
  std::array<Integrals, 8> integrals;
  for (int c = 0; c < 8; ++c) integrals[c] = integrals_of(cells[c]);
  fit(
      node, [&](int c) { return integrals[c].data(); }, a);
}

void InteriorFit::at_all(const std::vector<int>& nodes, double* values) const {
  if (nodes.empty()) return;
  std::vector<std::array<int, 8>> cells(nodes.size());
  parallel_for("cgcontact::interior_fit::cells", nodes.size(), grain_of_medium,
               [&](std::size_t i) { find_cells(nodes[i], cells[i].data()); });
  int low = cells[0][0], high = low;
  for (const std::array<int, 8>& of_node : cells) {
    low = std::min(low, of_node[0]);
    high = std::max(high, of_node[7]);
  }
  std::vector<int> row(high - low + 1, -1), list;
  for (const std::array<int, 8>& of_node : cells)
    for (const int cell : of_node)
      if (row[cell - low] < 0) {
        row[cell - low] = static_cast<int>(list.size());
        list.push_back(cell);
      }
  std::vector<Integrals> integrals(list.size());
  parallel_for("cgcontact::interior_fit::integrals", list.size(), grain_of_medium,
               [&](std::size_t i) { integrals[i] = integrals_of(list[i]); });
  parallel_for("cgcontact::interior_fit::fits", nodes.size(), grain_of_medium, [&](std::size_t i) {
    fit(
        nodes[i], [&](int c) { return integrals[row[cells[i][c] - low]].data(); }, values + 6 * num_terms * i);
  });
}

Subset nodes_beside_interior(const BodyMesh& mesh, const CellLists& contacts) {
  const CutCells& cc = *mesh.cut_cells;
  std::vector<unsigned char> full_cells(mesh.num_nodes, 0);
  for (std::size_t c = 0; c < mesh.cell_nodes.size(); ++c) {
    const int cell = static_cast<int>(c);
    if (cc.cut_of_active[cell] >= 0 || !contacts[cell].empty()) continue;
    for (const int corner : mesh.cell_nodes[cell])
      full_cells[corner - mesh.first_node] += cc.level(cell) == level_of(mesh, corner - mesh.first_node);
  }
  std::vector<char> beside(mesh.num_nodes);
  for (int n = 0; n < mesh.num_nodes; ++n) beside[n] = full_cells[n] < 8 || !mesh.is_free(n);
  for (int n = 0; n < mesh.num_nodes; ++n)
    if (!mesh.is_free(n)) each_master(mesh, n, [&](int master, double) { beside[master] = 1; });
  return Subset(beside);
}

}  // namespace cgcontact
