/// Times and memory of everything but the linear solver, at any size: the displacement is made up, so that nothing is
/// solved. One line per phase: seconds, processor seconds (a busy machine does not
/// change them much), memory held after it and peak within it, both also in bytes per unknown.
///   bench_phases SCENE [KEY=VALUE ...]      (results are written to bench_phases.out and removed)
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "contact/simulation.hpp"
#include "contact/solve/boundary_stress.hpp"
#include "core/output/output.hpp"
#include "core/scene_file/read_scene.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "perf/process_memory.hpp"

namespace {

using namespace cgcontact;

struct Phase {
  std::string name;
  double seconds, processor, held, peak;
};

class Recorder {
 public:
  template <class Work>
  void operator()(const std::string& name, const Work& work) {
    perf::reset_peak_memory();
    const std::clock_t used = std::clock();
    const auto start = std::chrono::steady_clock::now();
    work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double processor = static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    phases_.push_back({name, seconds, processor, perf::status_bytes("VmRSS"), perf::status_bytes("VmHWM")});
  }

  void print(long long unknowns) const {
    const double n = static_cast<double>(unknowns);
    double sum = 0, processor = 0;
    fmt::print("{} unknowns\n{:28} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7}\n", unknowns, "", "s", "cpu s", "held MB",
               "peak MB", "held B", "peak B");
    for (const Phase& p : phases_) {
      fmt::print("{:28} {:9.4f} {:9.4f} {:9.1f} {:9.1f} {:7.0f} {:7.0f}\n", p.name, p.seconds, p.processor,
                 p.held / 1e6, p.peak / 1e6, p.held / n, p.peak / n);
      sum += p.seconds;
      processor += p.processor;
    }
    fmt::print("{:28} {:9.4f} {:9.4f}\n", "sum", sum, processor);
  }

 private:
  std::vector<Phase> phases_;
};

/// A smooth displacement of about the size of the problem's, with strains that vary over the body.
RealView made_up_displacement(const Simulation& sim) {
  RealView u("bench_phases::u", sim.state.system.num_dofs());
  auto host = Kokkos::create_mirror_view(u);
  for (const BodyMesh& mesh : sim.state.system.meshes) {
    const Grid& grid = mesh.cut_cells->grid;
    const double length = grid.cell_size * *std::max_element(grid.num_cells.begin(), grid.num_cells.end());
    for (int n = 0; n < mesh.num_nodes; ++n) {
      const Index3& i = mesh.nodes[n];
      const Vec3 x = (grid.to_global(Vec3(i[0], i[1], i[2])) - grid.origin) / length;
      const Vec3 value(0.1 * x[0] * x[1], std::sin(2 * x[1] + x[2]), 0.3 * x[2] * x[2] - std::cos(3 * x[1] + x[0]));
      for (int k = 0; k < 3; ++k) host(dof_of(mesh.first_node + n, k)) = 1e-3 * grid.rotation.col(k).dot(value);
    }
  }
  Kokkos::deep_copy(u, host);
  return u;
}

/// Half of each pair's points are closed: those at the lower end of a slanted line.
void made_up_contact(Simulation& sim) {
  for (ContactPair& pair : sim.state.pairs) {
    const auto coordinate = [](const ContactPoint& q) { return q.x.dot(Vec3(0.1, 1, 0.2)); };
    double mean = 0;
    for (const ContactPoint& q : pair.points) mean += coordinate(q) / static_cast<double>(pair.points.size());
    for (std::size_t q = 0; q < pair.points.size(); ++q) pair.points.set_active(q, coordinate(pair.points[q]) < mean);
  }
}

void run(const Scene& scene) {
  Recorder phase;
  Simulation sim(scene);
  phase("prepare (cut cells, pairs)", [&] { sim.set_up_grids(); });
  phase("mesh, operator", [&] { sim.make_system(); });
  std::vector<BoundaryStress> stress;
  phase("boundary stress, patches", [&] {
    const auto cells = stabilised_cells(sim.state.supports, sim.state.pairs, sim.state.bodies.size());
    for (std::size_t b = 0; b < cells.size(); ++b)
      stress.emplace_back(sim.state.system.meshes[b], scene.recovery.patch_volume, cells[b]);
  });
  std::vector<double> load;
  phase("load vector", [&] { load = make_load_vector(sim.state.bodies, sim.state.system, sim.state.scales); });
  made_up_contact(sim);
  OuterResult solution;
  phase("(displacement)", [&] { solution.u = made_up_displacement(sim); });
  solution.body_motions.resize(sim.state.bodies.size());
  solution.group_force.assign(sim.state.system.group_rows.size(), 0.0);
  solution.support_stress.assign(sim.state.supports.size(), 0.0);
  solution.load_of_body.assign(sim.state.bodies.size(), Vec3::Zero());
  sim.state.take(std::move(solution));
  phase("boundary stress, 8 updates", [&] {
    for (int i = 0; i < 8; ++i)
      for (BoundaryStress& s : stress) s.update(sim.state.outer.u);
  });
  stress.clear();
  phase("recovery", [&] { sim.recover(); });
  phase("error estimate, results", [&] { sim.fill_results(); });
  phase("output", [&] { write_results(sim.results, scene, "bench_phases.out"); });
  std::filesystem::remove_all("bench_phases.out");
  phase.print(sim.state.system.num_dofs());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: {} SCENE [KEY=VALUE ...]\n", argv[0]);
    return 1;
  }
  try {
    const Scene scene = read_scene(argv[1], std::vector<std::string>(argv + 2, argv + argc));
    const TrilinosScope trilinos(0);
    run(scene);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
