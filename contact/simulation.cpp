#include "contact/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "contact/condition_checks.hpp"
#include "contact/free_motion.hpp"
#include "contact/memory.hpp"
#include "contact/postprocess.hpp"
#include "contact/pressure_estimate.hpp"
#include "contact/reference.hpp"
#include "contact/small_strain.hpp"
#include "core/resources.hpp"

namespace cgcontact {
namespace {

/// Of the memory that is expected before the cells are known; the cells themselves take less than half.
constexpr double surely_needed = 0.7;
/// Cells; bodies one cell thick are meant to be so. Those held on both sides (plane strain) may be thinner.
constexpr double nearly_one = 0.99;

/// The shortest side of the bounding box along the grid's axes, cells.
double thickness_on_grid(const BodySpec& body) {
  Vec3 min, max;
  body.solid.transformed(body.grid_rotation.transpose(), Vec3::Zero()).bounding_box(min, max);
  return (max - min).minCoeff() / body.cell_size;
}

/// Wall time of named phases.
class PhaseClock {
 public:
  PhaseClock(std::vector<std::pair<std::string, double>>& times, const ProgressCallbacks& progress)
      : times_(times), progress_(progress) {}
  template <class Work>
  void operator()(const std::string& phase, const Work& work) {
    progress_.phase(phase);
    const auto start = std::chrono::steady_clock::now();
    work();
    Kokkos::fence();
    times_.emplace_back(phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }

 private:
  std::vector<std::pair<std::string, double>>& times_;
  const ProgressCallbacks& progress_;
};

}  // namespace

Scales make_scales(const Scene& scene) {
  Scales scales{0, 0};
  for (const BodySpec& body : scene.bodies) {
    scales.length = std::max(scales.length, body.cell_size);
    scales.stress = std::max(scales.stress, body.material.youngs_modulus);
  }
  return scales;
}

void check_memory(const Scene& scene, const Preparation& preparation) {
  std::vector<BodySize> sizes;
  for (const BodyModel& body : preparation.bodies) sizes.push_back(size_of(body.cut_cells));
  check_memory(scene, sizes);
}

Preparation prepare(const Scene& scene) {
  std::vector<BodySize> sizes;
  for (const BodySpec& body : scene.bodies) sizes.push_back(estimate_size(body));
  check_memory(scene, sizes, surely_needed);
  Preparation p;
  p.bodies = make_body_models(scene);
  p.supports = make_support_points(scene, p.bodies);
  p.pairs = make_contact_pairs(scene, p.bodies);
  check_conditions(scene, p.bodies, p.pairs);
  // Contact points are all closed before the solve: a motion that is free even so is a mistake in the scene.
  const std::string motion = find_free_motion(scene, p.bodies, p.supports, p.pairs);
  if (!motion.empty()) throw InputError(scene.file + ": " + motion);
  [[maybe_unused]] const Reference readable(scene, scene.reference);
  return p;
}

void Simulation::run(const ProgressCallbacks& progress) {
  PhaseClock phase(results.times_s, progress);
  phase("cut cells", [&] { place_on_grids(); });
  phase("operator", [&] { make_system(); });
  phase("solve", [&] {
    OuterProblem problem{scene, bodies, patches, pairs, supports, system, scales};
    outer = solve_contact(problem, progress.step);
  });
  phase("recovery", [&] { recover(); });
  phase("error estimate", [&] { fill_results(); });
  results.peak_memory_bytes = peak_memory_bytes();
}

void Simulation::place_on_grids() {
  for (const BodySpec& body : scene.bodies) {
    results.warnings.insert(results.warnings.end(), body.warnings.begin(), body.warnings.end());
    if (body.material.poisson_ratio > 0.48)
      results.warnings.push_back(fmt::format(
          "body \"{}\": nu = {:g}: trilinear elements lock near 0.5 and lose accuracy, compare with finer cells",
          body.name, body.material.poisson_ratio));
  }
  Preparation p = prepare(scene);
  check_memory(scene, p);
  bodies = std::move(p.bodies);
  for (const BodyModel& body : bodies)
    if (const double thickness = thickness_on_grid(*body.spec); thickness < nearly_one && body.free_thickness < 1)
      results.warnings.push_back(
          fmt::format("body \"{}\": its bounding box is {:.2g} cells thin: bending and the stress "
                      "across it are not resolved, smaller cells are needed",
                      body.spec->name, thickness));
  supports = std::move(p.supports);
  pairs = std::move(p.pairs);
}

void Simulation::make_system() {
  scales = make_scales(scene);
  std::vector<const CutCells*> cut_cells;
  std::vector<Material> materials;
  for (const BodyModel& body : bodies) {
    cut_cells.push_back(&body.cut_cells);
    materials.push_back(body.spec->material);
  }
  system = make_elastic_system(cut_cells, materials, scales, scene.solver.ghost_penalty);
  add_supports(scene, bodies, supports, scales, system);
  set_group_rows(system, make_group_rows(pairs, bodies, system));
  for (const ContactPair& pair : pairs)
    for (const ContactGroup& g : pair.groups)
      system.full_group_stiffness.push_back(pair.stiffness * g.area / (scales.stress * scales.length));
  for (const BodyMesh& mesh : system.meshes) patches.push_back(make_patches(mesh, scene.recovery.patch_volume));
}

void Simulation::recover() {
  std::vector<RecoveryBody> input;
  std::vector<double> group_force = outer.group_force;
  for (double& force : group_force) force *= scales.stress * scales.length * scales.length;
  update_contact_links(pairs, bodies, group_force);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const RecoveredField field{Subset(mesh.num_nodes),
                               CoefficientView("cgcontact::simulation::recovered", mesh.num_nodes)};
    const int singular = recover_all(mesh, patches[b], outer.u, field);
    if (singular > 0)
      results.warnings.push_back(std::to_string(singular) + " patches of body \"" + bodies[b].spec->name +
                                 "\" were singular: constant stress used there");
    spr.push_back(part_of(field, nodes_near_contact(pairs, bodies, static_cast<int>(b), mesh)));
    sprc.push_back(field);
    input.push_back({&mesh, &patches[b], &bodies[b].boundary, field});
  }
  if (scene.recovery.spr_c) {
    const RecoveryOptions options{scene.recovery.rank_tolerance,  scene.recovery.auxiliary_depth,
                                  scene.recovery.contact_edge,    scene.recovery.degree,
                                  scene.recovery.rings,           scene.recovery.points_per_face,
                                  scene.recovery.inverse_variance};
    ConstrainedRecovery recovery = recover_constrained(input, outer.u, scales, options);
    recovery_counts = recovery.counts;
    patch_states = std::move(recovery.states);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!recovery.quadratic[b].values.empty())
        sprc[b].quadratic = std::make_shared<QuadraticTerms>(std::move(recovery.quadratic[b]));
      if (!recovery.edges[b].terms.empty()) sprc[b].edge = std::make_shared<EdgeTerms>(std::move(recovery.edges[b]));
    }
  }
  patches.clear();
}

/// The scene's reference at the computed force. Without any force, one that depends on it says nothing.
void Simulation::choose_reference() {
  const double force = results.pairs.empty() ? 0 : results.pairs.front().force_on_first.norm();
  if (!scene.late_reference || force > 0) {
    reference = scene.reference_at(force);
  } else {
    reference = {};
    results.warnings.emplace_back(
        "the first contact pair carries no force: the reference depends on it and is left out");
  }
}

void Simulation::fill_results() {
  fill_counts(*this, results);
  fill_contact_rows(*this, results);
  fill_pair_figures(*this, results);
  choose_reference();
  fill_body_fields(*this, results);
  estimate_contact_errors(*this, results);
  fill_path(*this, results);
  fill_pressure_errors(*this, results);
  if (outer.converged)
    for (const std::string& warning : small_strain_warnings(*this)) results.warnings.push_back(warning);
}

}  // namespace cgcontact
