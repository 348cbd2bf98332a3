#include "perf/problems.hpp"

#include <random>
#include <set>

namespace cgcontact::perf {

BlockProblem::BlockProblem(int size) {
  Grid grid;
  grid.num_cells = {size + 1, size + 1, size + 1};
  const Vec3 start(0.414, 0.732, 0.236);
  cut_cells = make_cut_cells(Solid::box(start, start + Vec3::Constant(size), "block"), grid);
  system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
}

SceneProblem::SceneProblem(const std::string& file, const std::vector<std::string>& overrides)
    : scene(read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + file, overrides)),
      parts(prepare(scene)),
      scales{0, 0} {
  std::vector<const CutCells*> cut_cells;
  std::vector<Material> materials;
  for (const BodyModel& body : parts.bodies) {
    cut_cells.push_back(&body.cut_cells);
    materials.push_back(body.spec->material);
    scales.length = std::max(scales.length, body.spec->cell_size);
    scales.stress = std::max(scales.stress, body.spec->material.youngs_modulus);
  }
  system = make_elastic_system(cut_cells, materials, scales, scene.solver.ghost_penalty);
  set_group_rows(system, make_group_rows(parts.pairs, parts.bodies, system));
  for (const BodyMesh& mesh : system.meshes) patches.push_back(make_patches(mesh));
  update_contact_links(parts.pairs, parts.bodies);
}

BodyMesh only_cells(const BodyMesh& mesh, bool interior) {
  BodyMesh part = mesh;
  std::vector<int> kept;
  part.colour_begin.assign(1, 0);
  for (std::size_t colour = 0; colour + 1 < mesh.colour_begin.size(); ++colour) {
    for (int c = mesh.colour_begin[colour]; c < mesh.colour_begin[colour + 1]; ++c)
      if ((mesh.matrix_of_cell(c) == 0) == interior) kept.push_back(c);
    part.colour_begin.push_back(static_cast<int>(kept.size()));
  }
  part.nodes_of_cell = CellNodesView("cgcontact::perf::nodes_of_cell", kept.size());
  part.matrix_of_cell = IntView("cgcontact::perf::matrix_of_cell", kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (int a = 0; a < 8; ++a) part.nodes_of_cell(i, a) = mesh.nodes_of_cell(kept[i], a);
    part.matrix_of_cell(i) = mesh.matrix_of_cell(kept[i]);
  }
  return part;
}

int count_nodes(const BodyMesh& mesh) {
  std::set<int> nodes;
  for (std::size_t c = 0; c < mesh.nodes_of_cell.extent(0); ++c)
    for (int a = 0; a < 8; ++a) nodes.insert(mesh.nodes_of_cell(c, a));
  return static_cast<int>(nodes.size());
}

RealView random_vector(int size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RealView x("cgcontact::perf::random", size);
  for (int i = 0; i < size; ++i) x(i) = uniform(generator);
  return x;
}

}  // namespace cgcontact::perf
