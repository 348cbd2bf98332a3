#include "contact/stress_recovery.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "contact/results/face_problems/face_problems.hpp"
#include "recovery/constrained/divergence.hpp"
#include "recovery/error/error_estimate.hpp"

namespace cgcontact {
namespace {

/// Gives the contact links of the bodies what the solution transmits.
void update_links(SolvedState& state) {
  std::vector<double> group_force = state.outer.group_force;
  for (double& force : group_force) force *= force_unit(state);
  update_contact_links(state.pairs, state.bodies, group_force, state.outer.friction);
}

/// Makes the field of a body, without values. Interior patches follow from the displacements by themselves, unless they
/// are to have polynomials of degree 2.
RecoveredField empty_field(const SolvedState& state, std::size_t body, const RealView& u) {
  const RecoveryOptions& options = state.scene.recovery;
  const BodyMesh& mesh = state.system.meshes[body];
  const bool interior_apart = !options.spr_c || options.degree.interior == 1;
  RecoveredField field;
  if (interior_apart && !mesh.rigid) {
    field.nodes = nodes_beside_interior(mesh, state.bodies[body].boundary.links_of_cell);
    field.interior = std::make_shared<InteriorFit>(mesh, u, false);
  } else {
    field.nodes = Subset(mesh.num_nodes);
  }
  field.values = CoefficientView(
      Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::stress_recovery::recovered"), field.nodes.size());
  return field;
}

/// Recovers the stress of a body by plain SPR over the patches, which it makes.
void recover_plain(SolvedState& state, std::size_t body, PatchSet& patches, std::vector<std::string>& warnings) {
  const BodyMesh& mesh = state.system.meshes[body];
  const RecoveredField field = empty_field(state, body, state.outer.u);
  patches = make_patches(mesh, state.scene.recovery.patch_volume, field.nodes);
  if (mesh.rigid) Kokkos::deep_copy(field.values, 0.0);
  const int singular = mesh.rigid ? 0 : recover_all(mesh, patches, state.outer.u, field);
  if (singular > 0)
    warnings.push_back(fmt::format("{} patches of body \"{}\" were singular: constant stress used there", singular,
                                   state.bodies[body].spec->name));
  state.spr.push_back(
      restricted_field(field, nodes_near_contact(state.pairs, state.bodies, static_cast<int>(body), mesh)));
  state.sprc.push_back(field);
}

/// Estimates the errors of the approaches of pairs in a body, by plain SPR over the patches; none where it is done.
void estimate_approaches(SolvedState& state, std::size_t body, const PatchSet& patches) {
  const BodyMesh& mesh = state.system.meshes[body];
  for (Approach& approach : state.approaches) {
    if (approach.u.size() == 0) continue;
    std::vector<double> errors(mesh.cell_nodes.size(), 0.0);
    if (!mesh.rigid) {
      const RecoveredField field = empty_field(state, body, approach.u);
      recover_all(mesh, patches, approach.u, field);
      errors = estimate_error(mesh, state.scales, field, approach.u, {}).error_of_cell;
    }
    approach.error_of_cell.push_back(std::move(errors));
  }
}

/// Solves the problems on the contact faces.
void solve_faces(const ExecSpace& exec, SolvedState& state, std::vector<std::string>& warnings) {
  state.faces = solve_face_pressures(exec, state);
  for (const SolvedZone& zone : state.faces.zones)
    if (const FaceSolution& solution = zone.pressure.solution; !solution.converged)
      warnings.push_back(
          fmt::format("contact \"{}\": the problem on its face stopped after {} iterations, the most that are made; "
                      "its pressure still changes by {:.2g} of the force",
                      state.pairs[zone.pair].spec->name, solution.iterations, solution.change));
}

/// Turns the plain fields into those of SPR-C. faces: solved problems on the contact faces, or nullptr.
void constrain_fields(SolvedState& state, const std::vector<PatchSet>& patches, const FacePressures* faces) {
  std::vector<RecoveryBody> input;
  for (std::size_t b = 0; b < state.bodies.size(); ++b)
    input.push_back({&state.system.meshes[b], &patches[b], &state.bodies[b].boundary, state.sprc[b]});
  ConstrainedRecovery recovery =
      recover_constrained(HostExec(), input, state.outer.u, state.scales, state.scene.recovery, faces);
  state.recovery_counts = recovery.counts;
  state.patch_states = std::move(recovery.states);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    RecoveredField& field = state.sprc[b];
    if (!recovery.quadratic[b].values.empty())
      field.quadratic = std::make_shared<QuadraticTerms>(std::move(recovery.quadratic[b]));
    if (!recovery.edges[b].terms.empty()) field.edge = std::make_shared<EdgeTerms>(std::move(recovery.edges[b]));
    if (field.interior)
      field.interior = std::make_shared<InteriorFit>(
          state.system.meshes[b], state.outer.u, true,
          divergence_at_nodes(state.system.meshes[b], state.bodies[b].boundary, state.scales.stress));
  }
}

}  // namespace

std::vector<std::string> recover_stresses(const ExecSpace& exec, SolvedState& state) {
  state.spr.clear();
  state.sprc.clear();
  for (BodyModel& body : state.bodies) body.cut_cells.gather_moments();
  update_links(state);
  std::vector<std::string> warnings;
  std::vector<PatchSet> patches(state.bodies.size());
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    recover_plain(state, b, patches[b], warnings);
    estimate_approaches(state, b, patches[b]);
  }
  for (Approach& approach : state.approaches) approach.u = RealView();  // one entry per unknown and pair
  const RecoveryOptions& options = state.scene.recovery;
  if (!options.spr_c) return warnings;
  const bool on_face = options.pressure == PressureSource::face;
  if (on_face) solve_faces(exec, state, warnings);
  constrain_fields(state, patches, on_face ? &state.faces : nullptr);
  return warnings;
}

}  // namespace cgcontact
