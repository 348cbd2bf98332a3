#include "perf/problems.hpp"

#include <random>

#include "core/scene/read_scene.hpp"

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
      simulation(scene),
      system(simulation.state.system) {
  simulation.place_on_grids();
  simulation.make_system();
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
