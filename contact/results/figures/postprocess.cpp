#include "contact/results/figures/postprocess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact/model/around_axis.hpp"
#include "contact/results/figures/displacement_estimate.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/reference/pressure_error.hpp"
#include "contact/results/reference/reference.hpp"
#include "contact/solve/active_set.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/ranks.hpp"
#include "recovery/error/error_estimate.hpp"

namespace cgcontact {
namespace {

/// Kinds and statuses of the patches around each cell.
void fill_patch_states(const BodyMesh& mesh, const PatchStates& states, BodyFields& fields) {
  for (const auto& nodes : mesh.cell_nodes) {
    PatchKind kind = PatchKind::interior;
    PatchStatus status = PatchStatus::exact;
    for (int node : nodes) {
      kind = std::max(kind, states.kind[node - mesh.first_node]);
      status = std::max(status, states.status[node - mesh.first_node]);
    }
    fields.patch_kind.push_back(static_cast<unsigned char>(kind));
    fields.patch_status.push_back(static_cast<unsigned char>(status));
  }
}

double frobenius(const Sym3& s) { return tensor(s).norm(); }

}  // namespace

void fill_counts(const SolvedState& state, Results& results) {
  results.scene_file = state.scene.file;
  results.title = state.scene.title;
  results.unknowns = state.system.num_free_dofs();
  for (const BodyModel& body : state.bodies) {
    const long long active = static_cast<long long>(body.cut_cells.cells.size());
    const long long cut = static_cast<long long>(body.cut_cells.active_of_cut.size());
    results.cells.active += active;
    results.cells.cut += cut;
    results.cells.interior += active - cut;
    results.cells.joined += body.cut_cells.num_pruned;
  }
  results.outer_iterations = state.outer.iterations;
  results.linear_iterations = state.outer.linear_iterations;
  const PreconditionerReport& preconditioner = state.outer.preconditioner;
  results.linear_solver = {name_of(state.scene.solver.method),
                           name_of(state.scene.solver.preconditioner),
                           preconditioner.unknowns,
                           preconditioner.cycles,
                           preconditioner.muelu_unknowns,
                           preconditioner.setups};
  results.outer_residuals = state.outer.residuals;
  results.active_of_iteration = state.outer.active_points;
  results.converged = state.outer.converged;
  results.diagnosis = state.outer.diagnosis;
  results.active_points = count_active(state.pairs);
  const RecoveryCounts& counts = state.recovery_counts;
  results.patch_kinds.assign(patch_kind_names, patch_kind_names + num_patch_kinds);
  results.patch_statuses.assign(patch_status_names, patch_status_names + num_patch_statuses);
  for (int k = 0; k < num_patch_kinds; ++k)
    if (counts.kinds[k] > 0) results.patches_by_kind.emplace_back(patch_kind_names[k], counts.kinds[k]);
  for (int k = 0; k < num_patch_statuses; ++k)
    if (counts.statuses[k] > 0) results.patches_by_status.emplace_back(patch_status_names[k], counts.statuses[k]);
  results.grown_patches = counts.grown;
  results.quadratic_patches = counts.quadratic;
  results.lowered_patches = counts.lowered;
  results.truncated_rows = counts.truncated_rows;
  results.inconsistent_patches = counts.statuses[static_cast<int>(PatchStatus::conflicting)];
}

namespace {

/// A body that expands freely has no stress: what is left is rounding of E times its strain, and no error. N m.
double energy_of_rounding(const BodyModel& body) {
  if (body.spec->rigid()) return 0;
  const double strain = rounding * body.expansion.norm();
  return body.spec->material.youngs_modulus * strain * strain * volume(body.cut_cells) *
         std::pow(body.cut_cells.grid.cell_size, 3);
}

}  // namespace

void fill_rank_figures(Results& results) {
  results.ranks = num_ranks();
  if (results.ranks == 1) return;
  results.rank_figures.clear();
  for (const RankWork& work : gather(std::vector<RankWork>{work_of_rank()}))
    results.rank_figures.push_back({work.unknowns, work.ghosts, work.cut_cells, work.messages, work.sent_bytes,
                                    work.reductions, work.reduced_bytes, 0});
}

std::vector<BodyFields> body_fields(const SolvedState& state) {
  std::vector<BodyFields> bodies;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    BodyFields fields;
    fields.name = state.bodies[b].spec->name;
    fields.cut_cells = &state.bodies[b].cut_cells;
    fields.material = state.bodies[b].spec->material;
    fields.displacement = [&state, b](int cell, const Vec3& xi) { return displacement(state, b, cell, xi); };
    fields.stress_raw = [&state, b](int cell, const Vec3& xi) { return raw_stress(state, b, cell, xi); };
    fields.stress_recovered = [&state, b](int cell, const Vec3& xi) {
      return recovered_stress(state, state.sprc[b], b, cell, xi);
    };
    fields.stress_at_corners = [&state, b](const std::vector<int>& cells, const std::vector<signed char>& corners) {
      return recovered_stress_at_corners(state, state.sprc[b], b, cells, corners);
    };
    bodies.push_back(std::move(fields));
  }
  return bodies;
}

void estimate_energy_errors(const SolvedState& state, Results& results) {
  const double energy = state.scales.stress * std::pow(state.scales.length, 3);
  double error = 0, solution = 0, exact_error = 0;
  const ReferenceSpec& reference = state.reference;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    ExactStress exact;
    if (!reference.stress_of_body.empty())
      exact = [&reference, b, &held_back = state.bodies[b].held_back](const Vec3& x) {
        Sym3 s;
        for (int k = 0; k < 6; ++k) s[k] = reference.stress_of_body[b][k](x);
        return Sym3(s - held_back);
      };
    EnergySums sums;
    if (const BodyMesh& mesh = state.system.meshes[b]; mesh.rigid)
      sums.error_of_cell = sums.solution_of_cell = std::vector<double>(mesh.cell_nodes.size(), 0.0);
    else
      sums = estimate_error(mesh, state.scales, state.sprc[b], state.outer.u, exact);
    error += sums.error;
    solution += sums.solution + energy_of_rounding(state.bodies[b]) / energy;
    exact_error += sums.exact_error;
    BodyFields& fields = results.bodies[b];
    fields.error_of_cell = std::move(sums.error_of_cell);
    for (double& e : fields.error_of_cell) e = std::sqrt(e * energy);
    fields.energy_of_cell = std::move(sums.solution_of_cell);
    for (double& e : fields.energy_of_cell) e *= energy;
    if (!state.patch_states.empty()) fill_patch_states(state.system.meshes[b], state.patch_states[b], fields);
  }
  results.estimated_error = std::sqrt(std::max(error, 0.0) * energy);
  results.estimated_error_relative = std::sqrt(std::max(error, 0.0) / std::max(solution, 1e-300));
  results.displacement_error_estimate =
      displacement_estimate(results.estimated_error_relative) + held_force_fraction(state, results.balance);
  if (!reference.stress_of_body.empty() && exact_error > 0) {
    results.has_effectivity = true;
    results.exact_error = std::sqrt(exact_error * energy);
    results.effectivity = std::sqrt(std::max(error, 0.0) / exact_error);
  }
}

namespace {

/// Returns the force on an end of a body in plane strain by the finite elements' stress, which holds the displacements.
Vec3 force_on_end(const SolvedState& state, const FaceRef& reference) {
  const BodyModel& body = state.bodies[reference.body];
  if (body.spec->axisymmetric()) return Vec3::Zero();  // it has no area
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  const BodyFace face(reference.face, body);
  Vec3 force = Vec3::Zero();
  if (body.spec->quadtree) {  // no points on its ends: nothing varies from one to the other
    const CutCells& cells = body.cut_cells;
    const Vec3 n = reference.face.normal_cone->first;
    for (int cell = 0; cell < static_cast<int>(cells.cells.size()); ++cell)
      force += cells.volume_fraction(cell) * std::pow(cells.h(cell), 2) *
               n.dot(tensor(raw_stress(state, reference.body, cell, centroid(cells, cell))) * n) * n;
    return force;
  }
  for (int p = 0; p < static_cast<int>(boundary.size()); ++p) {
    if (!face.contains(p)) continue;
    const int cell = boundary.cell[p];
    const Vec3 xi = cell_coordinates(body.cut_cells, cell, boundary.position[p]), n = body.normal(p);
    force += body.area(p) * n.dot(tensor(raw_stress(state, reference.body, cell, xi)) * n) * n;
  }
  return force;
}

/// Returns that of a face, m; zero for an end in plane strain without points.
Vec3 centroid_of(const SolvedState& state, const FaceRef& reference) {
  const BodyModel& body = state.bodies[reference.body];
  Vec3 first = Vec3::Zero();
  double area = 0;
  for (const int p : BodyFace(reference.face, body).points()) {
    first += body.area(p) * body.point(p);
    area += body.area(p);
  }
  return area > 0 ? Vec3(first / area) : Vec3(Vec3::Zero());
}

}  // namespace

std::vector<SupportFigures> support_figures(const SolvedState& state) {
  std::vector<SupportFigures> supports;
  for (const SupportSpec& support : state.scene.supports) {
    SupportFigures figures;
    figures.face = state.scene.bodies[support.face.body].name + "." + support.face.face.name;
    if (support.implied) figures.force = force_on_end(state, support.face);
    figures.about = centroid_of(state, support.face);
    supports.push_back(figures);
  }
  for (std::size_t s = 0; s < state.supports.size(); ++s) {
    const SupportPoint& p = state.supports[s];
    if (p.support < 0 || p.implied) continue;
    SupportFigures& figures = supports[p.support];
    const Vec3 force = p.weight * state.outer.support_stress[s] * p.direction;
    const Vec3 x = global_position(state.bodies[p.body].cut_cells, p.cell, p.xi);
    figures.force += force;
    figures.moment += (x - figures.about).cross(force);
  }
  for (std::size_t s = 0; s < state.scene.supports.size(); ++s) {
    const BodySpec& body = state.scene.bodies[state.scene.supports[s].face.body];
    sum_around_axis(body, supports[s].force, &supports[s].moment);
    sum_around_axis(body, supports[s].about);
    if (!body.plane_strain) continue;  // there the ends hold the body against moments about other axes
    const Vec3 axis = Vec3::Unit(static_cast<int>(*body.plane_strain));
    supports[s].moment = supports[s].moment.dot(axis) * axis;
  }
  return supports;
}

std::vector<BodyBalance> balance_of_bodies(const SolvedState& state, const std::vector<SupportFigures>& supports,
                                           const std::vector<PairFigures>& pairs) {
  std::vector<BodyBalance> all;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    BodyBalance balance;
    balance.body = state.bodies[b].spec->name;
    balance.loads = state.outer.load_of_body[b];
    sum_around_axis(*state.bodies[b].spec, balance.loads);
    for (std::size_t s = 0; s < supports.size(); ++s)
      if (state.scene.supports[s].face.body == static_cast<int>(b)) balance.supports += supports[s].force;
    balance.holds = holding_force(state, static_cast<int>(b));
    balance.supports += balance.holds;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      if (state.pairs[k].spec->first.body == static_cast<int>(b)) balance.contact += pairs[k].force_on_first;
      if (state.pairs[k].spec->second.body == static_cast<int>(b)) balance.contact += pairs[k].force_on_second;
    }
    all.push_back(balance);
  }
  return all;
}

void fill_pressure_errors(const SolvedState& state, Results& results) {
  const Reference reference(state.scene, state.reference);
  if (reference.has_stress())
    for (const ContactRow& r : results.contact_rows) {
      const Sym3 exact = reference.stress(r.body, r.x);
      results.stress_errors.push_back({r.body, r.x, frobenius(r.stress_raw - exact), frobenius(r.stress_spr - exact),
                                       frobenius(r.stress_sprc - exact)});
    }
  if (!reference.has_pressure() || results.contact_rows.empty()) return;
  results.pressure_errors = pressure_errors(
      results.contact_rows, [&](const ContactRow& r) { return reference.pressure(r.x); }, state.reference.zones);
  if (results.pressure_errors.empty()) {
    results.warnings.emplace_back("the reference pressure is zero on all contact faces: there is no error of it");
    return;
  }
  for (const auto& [name, inside] : state.reference.zones) {
    const auto is_this = [&zone = name](const ZoneError& error) { return error.zone == zone; };
    if (std::none_of(results.pressure_errors.begin(), results.pressure_errors.end(), is_this))
      results.warnings.push_back(fmt::format("reference.zones: \"{}\" contains no point of the contact faces", name));
  }
}

}  // namespace cgcontact
