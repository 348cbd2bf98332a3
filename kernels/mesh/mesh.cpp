#include "kernels/mesh/mesh.hpp"

#include "kernels/mesh/element_nodes.hpp"

namespace cgcontact {
bool is_ghost_face(const BodyMesh& mesh, int e, int f) {
  constexpr double well_filled = 0.25;
  const auto badly = [&](int cell) { return mesh.cut_cells->volume_fraction(cell) < well_filled; };
  return badly(e) || badly(f);
}

BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node) {
  BodyMesh mesh;
  mesh.cut_cells = &cut_cells;
  mesh.law = UnitElasticity(material.poisson_ratio);
  mesh.modulus = material.youngs_modulus / scales.stress;
  mesh.length = scales.length;
  mesh.first_node = first_node;
  ElementNodes<1> nodes = number_element_nodes<1>(cut_cells, first_node);
  mesh.num_nodes = static_cast<int>(nodes.numbers.size());
  mesh.node_numbers = std::move(nodes.numbers);
  mesh.nodes = std::move(nodes.places);
  mesh.cell_nodes = std::move(nodes.of_cell);
  return mesh;
}

}  // namespace cgcontact
