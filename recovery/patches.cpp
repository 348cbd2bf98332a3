#include "recovery/patches.hpp"

#include <algorithm>

namespace cgcontact {
namespace {

/// Volume and first and second moments about the centre from the Legendre moments of the cell.
void cell_mass(const Moments& m, double out[10]) {
  constexpr int n = moment_degree + 1;
  const auto L = [&](int i, int j, int k) { return m[(i * n + j) * n + k] / 8; };
  const auto square = [&](double l2) { return (2 * l2 + L(0, 0, 0)) / 3; };  // xi^2 = (2 L_2 + 1) / 3
  out[0] = L(0, 0, 0);
  out[1] = L(1, 0, 0) / 2;
  out[2] = L(0, 1, 0) / 2;
  out[3] = L(0, 0, 1) / 2;
  out[4] = square(L(2, 0, 0)) / 4;
  out[5] = square(L(0, 2, 0)) / 4;
  out[6] = square(L(0, 0, 2)) / 4;
  out[7] = L(1, 1, 0) / 4;
  out[8] = L(0, 1, 1) / 4;
  out[9] = L(1, 0, 1) / 4;
}

/// Joins patches of less than one cell of volume with the patch of the fullest neighbouring node (prototype, section 5:
/// the condition of the patch mass stays below 370).
void grow_patches(const BodyMesh& mesh, std::vector<std::vector<int>>& patches, std::vector<char>& grown) {
  const CutCells& cc = *mesh.cut_cells;
  std::vector<double> volume(mesh.num_nodes, 0.0);
  for (int n = 0; n < mesh.num_nodes; ++n)
    for (int c : mesh.cells_of_node[n]) volume[n] += cc.volume_fraction(c);
  for (int n = 0; n < mesh.num_nodes; ++n) {
    double have = volume[n];
    for (int step = 0; step < 3 && have < 1; ++step) {
      double best = -1;
      int anchor = -1;
      for (int c : patches[n])
        for (int node : mesh.cell_nodes[c]) {
          const int m = node - mesh.first_node;
          double distance = 0;
          for (int d = 0; d < 3; ++d) distance += std::pow(mesh.nodes[m][d] - mesh.nodes[n][d], 2);
          const double score = volume[m] - 1e-3 * std::sqrt(distance);
          if (score > best * (1 + 1e-9)) best = score, anchor = m;
        }
      const std::size_t before = patches[n].size();
      for (int c : mesh.cells_of_node[anchor])
        if (std::find(patches[n].begin(), patches[n].end(), c) == patches[n].end()) {
          patches[n].push_back(c);
          have += cc.volume_fraction(c);
        }
      if (patches[n].size() == before) break;
      grown[n] = 1;
    }
    std::sort(patches[n].begin(), patches[n].end());
  }
}

}  // namespace

PatchSet make_patches(const BodyMesh& mesh) {
  const CutCells& cc = *mesh.cut_cells;
  PatchSet set;
  std::vector<std::vector<int>> patches = mesh.cells_of_node;
  set.grown.assign(mesh.num_nodes, 0);
  grow_patches(mesh, patches, set.grown);
  set.begin.assign(1, 0);
  for (const auto& patch : patches) {
    set.cells.insert(set.cells.end(), patch.begin(), patch.end());
    set.begin.push_back(static_cast<int>(set.cells.size()));
  }
  const std::size_t num_cells = cc.cells.size(), num_cut = cc.moments.size();
  set.begin_view = IntView("cgcontact::patches::begin", set.begin.size());
  set.cells_view = IntView("cgcontact::patches::cells", set.cells.size());
  set.mass = CellMassView("cgcontact::patches::mass", num_cells);
  set.weights = RealView("cgcontact::patches::weights", 27 * (1 + num_cut));
  set.weights_of_cell = IntView("cgcontact::patches::weights_of_cell", num_cells);
  set.nodes_of_cell = CellNodesView("cgcontact::patches::nodes_of_cell", num_cells);
  set.cell_centre = decltype(set.cell_centre)("cgcontact::patches::cell_centre", num_cells);
  set.node_position = decltype(set.node_position)("cgcontact::patches::node_position", mesh.num_nodes);
  using HostUnmanaged = Kokkos::View<const int*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
  Kokkos::deep_copy(set.begin_view, HostUnmanaged(set.begin.data(), set.begin.size()));
  Kokkos::deep_copy(set.cells_view, HostUnmanaged(set.cells.data(), set.cells.size()));
  auto mass = Kokkos::create_mirror_view(set.mass);
  auto weights = Kokkos::create_mirror_view(set.weights);
  auto row = Kokkos::create_mirror_view(set.weights_of_cell);
  auto nodes = Kokkos::create_mirror_view(set.nodes_of_cell);
  auto centre = Kokkos::create_mirror_view(set.cell_centre);
  auto position = Kokkos::create_mirror_view(set.node_position);
  for (std::size_t e = 0; e < num_cells; ++e) {
    const int cut = cc.cut_of_active[e];
    cell_mass(cut < 0 ? full_cell_moments() : cc.moments[cut], &mass(e, 0));
    row(e) = 1 + cut;
    for (int a = 0; a < 8; ++a) nodes(e, a) = mesh.cell_nodes[e][a];
    for (int i = 0; i < 3; ++i) centre(e, i) = cc.cells[e][i] + 0.5;
  }
  for (int n = 0; n < mesh.num_nodes; ++n)
    for (int i = 0; i < 3; ++i) position(n, i) = mesh.nodes[n][i];
  Kokkos::deep_copy(set.cell_centre, centre);
  Kokkos::deep_copy(set.node_position, position);
  for (std::size_t m = 0; m <= num_cut; ++m)
    fitted_weights(m == 0 ? full_cell_moments() : cc.moments[m - 1], 3, &weights(27 * m));
  Kokkos::deep_copy(set.mass, mass);
  Kokkos::deep_copy(set.weights, weights);
  Kokkos::deep_copy(set.weights_of_cell, row);
  Kokkos::deep_copy(set.nodes_of_cell, nodes);
  return set;
}

}  // namespace cgcontact
