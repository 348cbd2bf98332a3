#include "kernels/reference/plain_matrix.hpp"

#include <algorithm>

#include "kernels/operator/element_matrices.hpp"
#include "kernels/reference/coloured_mesh.hpp"

namespace cgcontact {
namespace {

/// Nodes touched by an active contact group.
std::vector<int> nodes_of_group(const GroupRow& row) {
  std::vector<int> nodes;
  for (const auto& entry : row.entries)
    if (nodes.empty() || nodes.back() != node_of_dof(entry.first)) nodes.push_back(node_of_dof(entry.first));
  return nodes;
}

/// Ghost faces of a body, with their factor of the penalty.
struct HostFaces {
  decltype(Kokkos::create_mirror_view(FaceNodesView())) nodes;
  decltype(Kokkos::create_mirror_view(RealView())) ring;
};

std::vector<HostFaces> ghost_faces(const ElasticSystem& system) {
  std::vector<HostFaces> faces;
  for (const BodyMesh* level : system.level_meshes()) {
    const ColouredMesh mesh = colour_mesh(*level);
    faces.push_back({Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), mesh.nodes_of_face),
                     Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), mesh.ring_of_face)});
  }
  return faces;
}

void make_graph(const ElasticSystem& system, const std::vector<HostFaces>& ghost_faces, BlockMatrix& A) {
  std::vector<std::vector<int>> neighbours(system.num_nodes);
  auto connect = [&](const auto& nodes, std::size_t n) {
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) neighbours[nodes[a]].push_back(nodes[b]);
  };
  auto compress = [](std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.shrink_to_fit();
  };
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    for (const auto& nodes : mesh.cell_nodes) connect(nodes, 8);
    const auto& faces = ghost_faces[b].nodes;
    for (std::size_t f = 0; f < faces.extent(0); ++f) connect(&faces(f, 0), 12);
    for (int n = 0; n < mesh.num_nodes; ++n) compress(neighbours[mesh.first_node + n]);
  }
  for (const GroupRow& row : system.group_rows) {
    const std::vector<int> nodes = nodes_of_group(row);
    connect(nodes, nodes.size());
  }
  A.begin.assign(1, 0);
  for (auto& list : neighbours) {
    compress(list);
    A.column.insert(A.column.end(), list.begin(), list.end());
    A.begin.push_back(A.column.size());
  }
  A.value.assign(9 * A.column.size(), 0.0);
}

void add_cells(const ElasticSystem& system, const std::vector<HostFaces>& ghost_faces, BlockMatrix& A) {
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    const CellMatrixView matrices = make_cell_matrices(mesh, system.supports[b]);
    const GhostMatrix ghost = make_ghost_matrix(mesh, system.ghost_penalty);
    auto K = Kokkos::create_mirror_view(matrices);
    Kokkos::deep_copy(K, matrices);
    for (std::size_t e = 0; e < mesh.cell_nodes.size(); ++e) {
      const int m = 1 + mesh.cut_cells->cut_of_active[e];
      for (int r = 0; r < 8; ++r)
        for (int c = 0; c < 8; ++c) {
          double* block = A.block(mesh.cell_nodes[e][r], mesh.cell_nodes[e][c]);
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) block[3 * i + j] += K(m, dof_of(r, i), dof_of(c, j));
        }
    }
    const auto& [faces, ring] = ghost_faces[b];
    for (std::size_t f = 0; f < faces.extent(0); ++f)
      for (int r = 0; r < 12; ++r)
        for (int c = 0; c < 12; ++c) {
          double* block = A.block(faces(f, r), faces(f, c));
          for (int i = 0; i < 3; ++i) block[4 * i] += ring(f) * ghost[r][c];
        }
  }
}

void add_groups(const ElasticSystem& system, BlockMatrix& A) {
  auto stiffness = Kokkos::create_mirror_view(system.groups.stiffness);
  Kokkos::deep_copy(stiffness, system.groups.stiffness);
  for (std::size_t g = 0; g < system.group_rows.size(); ++g) {
    if (stiffness(g) == 0) continue;
    for (const auto& [r, vr] : system.group_rows[g].entries)
      for (const auto& [c, vc] : system.group_rows[g].entries)
        A.block(node_of_dof(r), node_of_dof(c))[3 * component_of_dof(r) + component_of_dof(c)] +=
            stiffness(g) * vr * vc;
  }
}

}  // namespace

double* BlockMatrix::block(int row, int col) {
  const auto first = column.begin() + static_cast<std::ptrdiff_t>(begin[row]),
             last = column.begin() + static_cast<std::ptrdiff_t>(begin[row + 1]);
  return &value[9 * (std::lower_bound(first, last, col) - column.begin())];
}

BlockMatrix plain_matrix(const ElasticSystem& system) {
  BlockMatrix A;
  const std::vector<HostFaces> faces = ghost_faces(system);
  make_graph(system, faces, A);
  add_cells(system, faces, A);
  add_groups(system, A);
  return A;
}

}  // namespace cgcontact
