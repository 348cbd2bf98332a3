#include "perf/problems.hpp"

#include <cmath>
#include <functional>
#include <random>

#include "core/scene_file/read_scene.hpp"

namespace cgcontact::perf {

namespace {

/// Growth of the cells with the distance from the point of refinement, times `size`: with 6 levels the numbers of
/// unknowns then agree within 5 % (sizes 32 and 68).
constexpr double growth = 4.5;

/// Gives sizes of cells that grow with the distance from a point, from the finest of so many levels on.
std::function<double(const Vec3&, const Vec3&)> wanted_around(const Vec3& point, int size, int levels) {
  const double finest = std::ldexp(1.0, 1 - levels);
  return [=](const Vec3& low, const Vec3& high) {
    return std::max(finest, growth / size * (point - point.cwiseMax(low).cwiseMin(high)).norm());
  };
}

}  // namespace

BlockProblem::BlockProblem(int size, int levels) {
  const double edge = levels == 1 ? size : 0.5 * size;
  Grid grid;
  grid.num_cells.fill(static_cast<int>(std::ceil(edge)) + 1);
  const Vec3 start(0.414, 0.732, 0.236);
  const Solid block = Solid::box(start, start + Vec3::Constant(edge), "block");
  if (levels == 1) {
    cut_cells = make_cut_cells(block, grid);
  } else {
    const Vec3 point = start + edge * Vec3(0.5, 0.5, 1);
    const auto wanted = wanted_around(point, size, levels);
    cut_cells = make_cut_cells(block, grid, {}, {}, refine_cells(block.geometry(), grid, wanted, levels));
  }
  system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
}

DiscProblem::DiscProblem(int size, bool of_revolution) {
  constexpr int levels = 6;
  Grid grid;
  grid.plane_strain = 1;  // the axis of revolution is z, at x = 0
  grid.num_cells = {size + 2, 1, size + 2};
  grid.slice = std::ldexp(1.0, 1 - levels);
  grid.thickness = 1;
  if (of_revolution) grid.unit_radius = grid.thickness / (2 * pi);
  const Vec3 middle(0, 0, 0.236), across = 3 * Vec3::UnitY();  // beyond the layer
  const Solid disc = Solid::cylinder(middle - across, middle + across, size, "disc");
  const Solid quarter = Solid::intersect(disc, Solid::box(middle - across, Vec3(size + 2, 3, size + 2), "quarter"));
  const auto wanted = wanted_around(middle + size * Vec3::UnitZ(), size, levels);
  cut_cells = make_cut_cells(quarter, grid, {}, {}, refine_cells(quarter.geometry(), grid, wanted, levels));
  system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
}

void BlockProblem::hold_lower_face() {
  constexpr double kappa = 10, face = 0.236;
  std::vector<SupportTerm> terms;
  const BoundaryPoints& points = cut_cells.boundary;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (std::abs(points.position[p][2] - face) > 1e-9) continue;
    const int cell = points.cell[p];
    for (int d = 0; d < 3; ++d)
      terms.push_back({cell, cell_coordinates(cut_cells, cell, points.position[p]), Vec3::Unit(d),
                       kappa / cut_cells.size(cell) * points.weight[p]});
  }
  add_support_terms(system, 0, terms);
}

SceneProblem::SceneProblem(const std::string& file, const std::vector<std::string>& overrides)
    : scene(read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + file, overrides)),
      simulation(scene),
      system(simulation.state.system) {
  simulation.set_up_grids();
  simulation.make_system();
  patches = make_patches(system.meshes, scene.recovery.patch_volume);
  set_group_stiffness(system, system.full_group_stiffness);
  update_contact_links(simulation.state.pairs, simulation.state.bodies);
}

RealView random_vector(int size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RealView x("cgcontact::perf::random", size);
  for (int i = 0; i < size; ++i) x(i) = uniform(generator);
  return x;
}

}  // namespace cgcontact::perf
