#include "contact/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "contact/model/condition_checks.hpp"
#include "contact/model/conditions.hpp"
#include "contact/model/memory.hpp"
#include "contact/motions/free_motion.hpp"
#include "contact/motions/free_pieces.hpp"
#include "contact/results/coarse_facets.hpp"
#include "contact/results/missed_contact.hpp"
#include "contact/results/pair_figures.hpp"
#include "contact/results/postprocess.hpp"
#include "contact/results/pressure_estimate.hpp"
#include "contact/results/pressure_paths.hpp"
#include "contact/results/reference.hpp"
#include "contact/results/small_strain.hpp"
#include "contact/results/verdict.hpp"
#include "core/base/parallel.hpp"
#include "core/base/resources.hpp"

namespace cgcontact {
namespace {

/// Cells; bodies one cell thick are meant to be so. Those held on both sides (plane strain) may be thinner.
constexpr double nearly_one = 0.99;
/// A pair that has to see farther is solved again; so many times at most.
constexpr int most_extensions = 5;
/// Stiffness of what holds bodies while contact does not, of a support's on the softest body that contact joins them
/// to: less than what contact and the bodies below it resist, so that its rest position follows within the outer
/// iteration.
constexpr double soft_hold = 1e-4;
/// Loads whose part along a free motion is less than this part of them are in balance: they are integrated to 1e-9, or
/// to less where a face ends between quadrature points.
constexpr double no_load = 1e-7, little_load = 1e-3;

/// The shortest side of the bounding box along the grid's axes, cells.
double thickness_on_grid(const BodySpec& body) {
  Vec3 min, max;
  body.solid.transformed(body.grid_rotation.transpose(), Vec3::Zero()).bounding_box(min, max);
  return (max - min).minCoeff() / body.cell_size;
}

/// Wall time of named phases; a phase that comes again adds to its time.
class PhaseClock {
 public:
  PhaseClock(std::vector<std::pair<std::string, double>>& times, const ProgressCallbacks& progress)
      : times_(times), progress_(progress) {}
  template <class Work>
  void operator()(const std::string& phase, const Work& work) {
    progress_.phase(phase);
    const ProfiledRegion region(phase.c_str());
    const auto start = std::chrono::steady_clock::now();
    work();
    Kokkos::fence();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (auto& [name, sum] : times_)
      if (name == phase) {
        sum += seconds;
        return;
      }
    times_.emplace_back(phase, seconds);
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

/// For each body the least Young's modulus of those that contact pairs join to it, directly or over others, Pa.
static std::vector<double> softest_moduli(const Preparation& p) {
  std::vector<double> moduli;
  for (const BodyModel& body : p.bodies) moduli.push_back(body.spec->material.youngs_modulus);
  for (bool changed = true; changed;) {
    changed = false;
    for (const ContactPair& pair : p.pairs) {
      const double least = std::min(moduli[pair.primary], moduli[pair.secondary]);
      changed |= moduli[pair.primary] != least || moduli[pair.secondary] != least;
      moduli[pair.primary] = moduli[pair.secondary] = least;
    }
  }
  return moduli;
}

/// Motions that are free although all contact is closed: pieces that nothing holds, flat faces that slide on each
/// other, and whatever the loads drive, are mistakes in the scene. A body that spins in its contact with nothing to
/// drive it (ball, roller) is held: no force arises. So are motions along the surface of one side that the other side's
/// points seem to resist, as the contact of curved surfaces does between cells.
void check_free_motions(const Scene& scene, Preparation& p) {
  const auto refuse_driven = [&](const FreeMotions& free, double no_load, const std::string& text) {
    const FreeMotions driven = driven_by_loads(free, p.bodies, no_load);
    if (!driven.empty())
      throw InputError(fmt::format("{}: {}, and the loads drive it{}", scene.file, describe(driven, scene), text));
  };
  const std::string text = find_free_motion(scene, p.bodies, p.supports, p.pairs);
  const FreeMotions free = find_free_motions(p.bodies, p.supports, p.pairs);
  const FreeMotions on_both_sides = free_on_both_sides(free, p.bodies, p.pairs);
  if (!text.empty()) {
    refuse_driven(free, no_load, ": " + text);
    if (free.empty() || on_both_sides.slides()) throw InputError(scene.file + ": " + text);
  }
  std::vector<SupportPoint> held = hold(on_both_sides, p.bodies);
  // The exact pressure does no work on these. A rotation about the axis of another body's surface (a pin in a wider
  // hole) ends where the loads do none.
  const SurfaceMotions surface = find_surface_motions(p.bodies, p.supports, p.pairs);
  refuse_driven(surface.own, little_load, "");
  refuse_driven(surface.others.without_rotation(), little_load, "");
  FreeMotions along_surfaces = surface.own;
  along_surfaces.add(surface.others);
  along_surfaces.add(free);
  FreeMotions left = along_surfaces;
  left.leave_out(held, p.bodies);
  if (!left.empty() && driven_by_loads(along_surfaces, p.bodies, no_load).empty())
    p.warnings.push_back(describe(along_surfaces, scene) +
                         ": no load drives this motion, soft springs that follow it hold it");
  else if (!on_both_sides.empty())
    p.warnings.push_back(describe(on_both_sides, scene) +
                         ": no load drives this motion, it is held where it is, which takes no force");
  const std::vector<double> softest = softest_moduli(p);
  for (const FreeMotions& motions : motions_of_floating_bodies(p.bodies, p.supports))
    for (SupportPoint point : hold(motions, p.bodies)) {
      point.weight *= soft_hold * softest[point.body] / stabilising_modulus(p.bodies[point.body].spec->material);
      point.follows = true;
      held.push_back(point);
    }
  p.supports.insert(p.supports.end(), held.begin(), held.end());
}

double count_contact_points(const std::vector<ContactPair>& pairs) {
  double points = 0;
  for (const ContactPair& pair : pairs) points += static_cast<double>(pair.points.size());
  return points;
}

void check_memory(const Scene& scene, const Preparation& preparation) {
  std::vector<BodySize> sizes;
  for (const BodyModel& body : preparation.bodies) sizes.push_back(size_of(body.cut_cells));
  check_memory(scene, sizes, count_contact_points(preparation.pairs));
}

/// The recovery takes the body force at nodes, which may lie on a singular plane or outside of the body.
void check_body_forces(const std::vector<BodyModel>& bodies) {
  for (const BodyModel& body : bodies) {
    if (!body.boundary.body_force_at) continue;
    for (const Index3& cell : body.cut_cells.cells)
      body.boundary.body_force_at(body.cut_cells.grid.to_global(Vec3(cell[0], cell[1], cell[2])));
  }
}

/// Its files can be read, and its pressure has a value where the faces may touch. One that depends on the contact force
/// is left for later.
void check_reference(const Scene& scene, const std::vector<ContactPair>& pairs) {
  const Reference reference(scene, scene.reference);
  if (scene.late_reference || !reference.has_pressure()) return;
  for (const ContactPair& pair : pairs)
    for (const ContactPoint& point : pair.points) reference.pressure(point.x);
}

Preparation prepare(const Scene& scene, bool refuse_near_limit) {
  check_memory_early(scene, refuse_near_limit);
  Preparation p;
  p.bodies = make_body_models(scene);
  p.supports = make_support_points(scene, p.bodies);
  p.pairs = make_contact_pairs(scene, p.bodies);
  check_conditions(scene, p.bodies, p.pairs);
  check_free_motions(scene, p);
  check_body_forces(p.bodies);
  check_reference(scene, p.pairs);
  return p;
}

void Simulation::run(const ProgressCallbacks& progress) {
  PhaseClock phase(results.times_s, progress);
  phase("cut cells", [&] { place_on_grids(); });
  phase("operator", [&] { make_system(); });
  phase("solve", [&] { solve_steps(progress); });
  phase("recovery", [&] {
    recover();
    patches.clear();
  });
  phase("error estimate", [&] { fill_results(); });
  results.peak_memory_bytes = peak_memory_bytes();
}

/// Is there no force and no motion?
bool is_at_rest(const OuterResult& outer) {
  const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), outer.u);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (u(i) != 0) return false;
  for (const RigidPart& part : outer.rigid_parts)
    if (part.translation.norm() + part.rotation.norm() > 0) return false;
  return std::all_of(outer.group_force.begin(), outer.group_force.end(), [](double force) { return force == 0; });
}

/// All steps, each from the solution of the one before; figures of each, if the scene asks for steps. The last one is
/// the result.
void Simulation::solve_steps(const ProgressCallbacks& progress) {
  const std::vector<StepSpec> steps = scene.steps.empty() ? std::vector<StepSpec>{{}} : scene.steps;
  auto solver = std::make_unique<ContactSolver>(OuterProblem{scene, bodies, patches, pairs, supports, system, scales});
  std::string first_failure;
  int extensions = 0;
  for (std::size_t k = 0; k < steps.size();) {
    set_step(steps[k]);
    outer = solver->solve(progress.step);
    if (outer.converged && extensions < most_extensions && see_farther()) {
      ++extensions;
      make_system();
      solver = std::make_unique<ContactSolver>(OuterProblem{scene, bodies, patches, pairs, supports, system, scales});
      continue;
    }
    if (!scene.steps.empty()) record_step(steps[k], k + 1 == steps.size());
    if (!scene.steps.empty() && outer.converged && is_at_rest(outer))
      add_warning(
          fmt::format("step {} of {}: nothing acts, neither loads nor prescribed displacements nor overlap: no "
                      "force and no motion",
                      k + 1, steps.size()));
    if (!outer.converged && first_failure.empty())
      first_failure = scene.steps.empty() ? outer.diagnosis
                                          : fmt::format("step {} of {}: {}", k + 1, steps.size(), outer.diagnosis);
    ++k;
  }
  for (std::size_t k = 0; k < pairs.size() && k < outer.small_zone_groups.size(); ++k)
    if (outer.small_zone_groups[k] > 0)
      add_warning(
          fmt::format("contact \"{}\": a zone smaller than the cells in {} of them; its force is that of an "
                      "indented half-space, not resolved",
                      pairs[k].spec->name, outer.small_zone_groups[k]));
  outer.converged = first_failure.empty();
  outer.diagnosis = first_failure;
}

/// Loads, prescribed displacements and interferences of a step.
void Simulation::set_step(const StepSpec& step) {
  for (BodyModel& body : bodies) set_loads(scene, step.loads, body);
  for (SupportPoint& p : supports)
    if (!p.follows) p.value = step.displacements * p.prescribed;
  for (ContactPair& pair : pairs) set_interference(pair, step.interference * pair.spec->interference);
}

/// New pairs, if faces have met that no pair saw.
bool Simulation::see_farther() {
  const std::vector<double> reach = missed_contact(*this);
  if (reach.empty()) return false;
  pairs = make_contact_pairs(scene, bodies, reach);
  return true;
}

/// Figures of a step; the pairs of the last one are those of the results.
void Simulation::record_step(const StepSpec& step, bool is_last) {
  Results part;
  if (!is_last) {
    recover();
    fill_contact_rows(*this, part);
    fill_pair_figures(*this, part);
  }
  results.steps.push_back({step, outer.iterations, outer.converged, part.pairs});
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
  results.warnings.insert(results.warnings.end(), p.warnings.begin(), p.warnings.end());
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
  patches.clear();
  for (const BodyMesh& mesh : system.meshes) patches.push_back(make_patches(mesh, scene.recovery.patch_volume));
}

/// Once, however many steps give it.
void Simulation::add_warning(const std::string& warning) {
  std::vector<std::string>& all = results.warnings;
  if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
}

void Simulation::recover() {
  spr.clear();
  sprc.clear();
  std::vector<RecoveryBody> input;
  std::vector<double> group_force = outer.group_force;
  for (double& force : group_force) force *= scales.stress * scales.length * scales.length;
  update_contact_links(pairs, bodies, group_force);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const RecoveredField field{
        Subset(mesh.num_nodes),
        CoefficientView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::simulation::recovered"),
                        mesh.num_nodes)};
    const int singular = recover_all(mesh, patches[b], outer.u, field);
    if (singular > 0)
      add_warning(std::to_string(singular) + " patches of body \"" + bodies[b].spec->name +
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
}

/// The scene's reference at the computed force. Without any force, one that depends on it says nothing.
void Simulation::choose_reference() {
  const double force = results.pairs.empty() ? 0 : results.pairs.front().force_on_first.norm();
  if (!scene.late_reference || force > 0) {
    try {
      reference = scene.reference_at(force);
      const Reference known(scene, reference);
      for (const ContactRow& row : results.contact_rows)
        if (known.has_pressure()) known.pressure(row.x);
    } catch (const InputError& error) {  // known only now: the solution is none the worse for it
      reference = {};
      results.warnings.push_back(fmt::format("the reference is left out: {}", error.what()));
    }
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
  fill_support_figures(*this, results);
  if (!results.steps.empty()) results.steps.back().pairs = results.pairs;
  results.verdict = judge(*this);
  fill_balance(*this, results);
  choose_reference();
  fill_body_fields(*this, results);
  estimate_contact_errors(*this, results);
  fill_conditions(*this, results);
  fill_paths(*this, results);
  fill_pressure_errors(*this, results);
  if (outer.converged)
    for (const auto& warnings :
         {small_strain_warnings(*this), lost_force_warnings(*this, results), coarse_facet_warnings(*this)})
      for (const std::string& warning : warnings) add_warning(warning);
}

}  // namespace cgcontact
