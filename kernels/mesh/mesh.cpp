#include "kernels/mesh/mesh.hpp"

#include <algorithm>

#include "kernels/mesh/element_nodes.hpp"
#include "kernels/mesh/hanging_nodes.hpp"

namespace cgcontact {
namespace {

constexpr double well_filled = 0.25;

/// Modulus of a rigid body in preconditioners: soft ones hold contact less than the rigid body does.
constexpr double modulus_of_rigid = 1e3;

bool badly_filled(const CutCells& cells, int cell) { return cells.volume_fraction(cell) < well_filled; }

BodyMesh empty_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node) {
  BodyMesh mesh;
  mesh.cut_cells = &cut_cells;
  mesh.law = UnitElasticity(material.poisson_ratio);
  mesh.rigid = material.is_rigid();
  mesh.modulus = mesh.rigid ? modulus_of_rigid : material.youngs_modulus / scales.stress;
  mesh.length = scales.length;
  mesh.first_node = first_node;
  return mesh;
}

/// Finds the faces of a level towards cells of twice the size, of one of the levels before it (or of the same size,
/// which levels have on coarse grids of multigrid).
std::vector<LevelFace> find_level_faces(const std::vector<CutCells>& levels, std::size_t own) {
  std::vector<LevelFace> faces;
  const CutCells& cells = levels[own];
  for (std::size_t larger = 0; larger < own; ++larger) {
    const int steps = halvings(levels[larger].grid, cells.grid);
    if (steps > 1) continue;
    for (int e = 0; e < static_cast<int>(cells.cells.size()); ++e)
      for (int d = 0; d < 3; ++d)
        for (int side = -1; side <= 1; side += 2) {
          Index3 across = cells.cells[e];
          across[d] += side;
          if (cells.find(across) >= 0) continue;
          const int other = levels[larger].find({across[0] >> steps, across[1] >> steps, across[2] >> steps});
          if (other < 0 || !(badly_filled(cells, e) || badly_filled(levels[larger], other))) continue;
          faces.push_back({e, side < 0 ? across : cells.cells[e], d});
        }
  }
  return faces;
}

/// Joins the lists of all levels in turn.
void join_levels(BodyMesh& mesh) {
  int level = 0;
  for (const BodyMesh& level_mesh : mesh.level_meshes) {
    mesh.nodes.insert(mesh.nodes.end(), level_mesh.nodes.begin(), level_mesh.nodes.end());
    mesh.node_levels.insert(mesh.node_levels.end(), level_mesh.num_nodes, static_cast<signed char>(level++));
    mesh.cell_nodes.insert(mesh.cell_nodes.end(), level_mesh.cell_nodes.begin(), level_mesh.cell_nodes.end());
  }
}

}  // namespace

int BodyMesh::num_free_dofs() const {
  int count = 0;
  if (rigid) {
    for (int motion = 0; motion < 6; ++motion) count += moves(motion);
    return count;
  }
  count = (is_one_layer() ? dofs_per_node - 1 : dofs_per_node) * (num_nodes - static_cast<int>(constraints.size()));
  for (int n = 0; is_axisymmetric() && n < static_cast<int>(nodes.size()); ++n) count -= is_free(n) && is_on_axis(n);
  return count;
}

bool is_ghost_face(const BodyMesh& mesh, int e, int f) {
  return badly_filled(*mesh.cut_cells, e) || badly_filled(*mesh.cut_cells, f);
}

std::vector<Index3> virtual_cells(const BodyMesh& level_mesh) {
  std::vector<Index3> cells;
  for (const LevelFace& face : level_mesh.level_faces) {
    cells.push_back(face.lower);
    if (face.lower == level_mesh.cut_cells->cells[face.cell]) ++cells.back()[face.direction];
  }
  return cells;
}

BodyMesh number_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node,
                          bool joined) {
  BodyMesh mesh = empty_mesh(cut_cells, material, scales, first_node);
  const auto number = [](BodyMesh& level_mesh) {
    ElementNodes<1> nodes =
        number_element_nodes<1>(*level_mesh.cut_cells, level_mesh.first_node, virtual_cells(level_mesh));
    level_mesh.num_nodes = static_cast<int>(nodes.numbers.size());
    level_mesh.node_numbers = std::move(nodes.numbers);
    level_mesh.nodes = std::move(nodes.positions);
    level_mesh.cell_nodes = std::move(nodes.of_cell);
  };
  if (cut_cells.level_cells.empty()) {
    number(mesh);
    return mesh;
  }
  for (std::size_t p = 0; p < cut_cells.level_cells.size(); ++p) {
    mesh.level_meshes.push_back(empty_mesh(cut_cells.level_cells[p], material, scales, first_node + mesh.num_nodes));
    mesh.level_meshes.back().level_faces = find_level_faces(cut_cells.level_cells, p);
    number(mesh.level_meshes.back());
    mesh.num_nodes += mesh.level_meshes.back().num_nodes;
  }
  if (joined) join_levels(mesh);
  return mesh;
}

BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node) {
  BodyMesh mesh = number_body_mesh(cut_cells, material, scales, first_node, !cut_cells.cells.empty());
  if (mesh.level_meshes.empty() && !mesh.is_one_layer()) return mesh;
  mesh.constraints = mesh.level_meshes.empty() ? constrain_across(mesh) : constrain_nodes(mesh.level_meshes);
  mesh.constraint_of_node.assign(mesh.num_nodes, -1);
  for (std::size_t c = 0; c < mesh.constraints.size(); ++c)
    mesh.constraint_of_node[mesh.constraints[c].node - first_node] = static_cast<int>(c);
  return mesh;
}

}  // namespace cgcontact
