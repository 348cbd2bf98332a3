#include "contact/results/postprocess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/results/pair_figures.hpp"
#include "contact/results/pressure_error.hpp"
#include "contact/results/reference.hpp"
#include "core/base/parallel.hpp"
#include "recovery/error/error_estimate.hpp"

namespace cgcontact {
namespace {

/// Boundary points per chunk of the parallel loops.
constexpr std::size_t grain = 128;
/// The contact point that a boundary point is taken for has a normal within 60 degrees of its own.
constexpr double same_face = 0.5;
/// Of the largest pressure of a pair.
constexpr double rounding = 1e-9;

/// Stress in Pa and global axes of one of the three fields at cell coordinates.
Sym3 to_global(const Simulation& sim, int body, const double s[6]) {
  const Mat3& R = sim.bodies[body].cut_cells.grid.rotation;
  const Sym3 local = Eigen::Map<const Sym3>(s) * sim.scales.stress;
  return voigt(R * tensor(local) * R.transpose());
}

/// Without the body's rigid part.
void corner_displacements(const Simulation& sim, int body, int cell, double out[8][3]) {
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) out[a][i] = sim.outer.u(3 * sim.system.meshes[body].cell_nodes[cell][a] + i);
}

Sym3 raw_stress(const Simulation& sim, int body, int cell, const Vec3& xi) {
  const BodyMesh& mesh = sim.system.meshes[body];
  double u[8][3], s[6];
  corner_displacements(sim, body, cell, u);
  hex_stress(mesh.law, u, xi.data(), s);
  for (double& v : s) v *= mesh.stress_factor();
  return to_global(sim, body, s);
}

Sym3 recovered_stress(const Simulation& sim, const RecoveredField& field, int body, int cell, const Vec3& xi) {
  double s[6];
  evaluate_recovered(sim.system.meshes[body], field, cell, xi.data(), s);
  return to_global(sim, body, s);
}

double pressure(const Sym3& s, const Vec3& n) { return -n.dot(tensor(s) * n); }

/// Contact pair whose faces contain a boundary point of a body (index), or -1.
int pair_of_face(const Simulation& sim, int body, int boundary_point) {
  const BodyModel& model = sim.bodies[body];
  const Grid& grid = model.cut_cells.grid;
  const BoundaryPoints& points = model.cut_cells.boundary;
  const Vec3 x = grid.to_global(points.position_of_piece(boundary_point)),
             n = grid.rotation * points.normal_of_piece(boundary_point);
  for (std::size_t p = 0; p < sim.pairs.size(); ++p) {
    const ContactPair& pair = sim.pairs[p];
    if ((pair.primary == body || pair.secondary == body) &&
        pair.face(body).contains(model.surface_names(boundary_point), x, n))
      return static_cast<int>(p);
  }
  return -1;
}

/// The contact point nearest to a grid position in the same cell and on the same side of the body, or nullptr. `n`:
/// grid axes.
const ContactLink* nearest_link(const BodyModel& body, int cell, const Vec3& position, const Vec3& n, int pair) {
  const ContactLink* nearest = nullptr;
  for (int l : body.boundary.links_of_cell[cell]) {
    const ContactLink& link = body.boundary.links[l];
    if (link.pair != pair || link.normal.dot(n) < same_face) continue;
    if (!nearest || (link.position - position).squaredNorm() < (nearest->position - position).squaredNorm())
      nearest = &link;
  }
  return nearest;
}

/// No if all patches around are open on that side (position: grid coordinates): the traction is zero there, whatever
/// else the patches have to meet.
bool carries_pressure(const Simulation& sim, int body, int cell, int pair, const Vec3& position, const Vec3& n) {
  if (sim.patch_states.empty()) return true;
  const BodyModel& model = sim.bodies[body];
  const PatchStates& states = sim.patch_states[body];
  const int surface = states.open_sides.empty()
                          ? -1
                          : model.cut_cells.solid.surface_at(position, model.cut_cells.grid.rotation.transpose() * n);
  return states.presses(sim.system.meshes[body], cell, pair, surface);
}

/// Gap after deformation and the other body's pressure, seen from x along n; infinite and NaN if nothing is opposite.
void look_across(const Simulation& sim, int cell, const Vec3& xi, ContactRow& row) {
  const ContactPair& pair = sim.pairs[row.pair];
  const int other = pair.other(row.body);
  const auto opposite = find_opposite(sim.bodies, pair, row.body, row.x, row.normal);
  row.gap = row.distance = std::numeric_limits<double>::infinity();
  row.pressure_opposite = std::numeric_limits<double>::quiet_NaN();
  if (!opposite) return;
  const Vec3 other_xi = cell_coordinates(sim.bodies[other].cut_cells, opposite->cell, opposite->position);
  const Vec3 relative = displacement(sim, other, opposite->cell, other_xi) - displacement(sim, row.body, cell, xi);
  row.distance = opposite->distance;
  row.gap = opposite->distance - pair.interference + relative.dot(row.normal);
  row.pressure_opposite =
      carries_pressure(sim, other, opposite->cell, row.pair, opposite->position, -row.normal)
          ? pressure(recovered_stress(sim, sim.sprc[other], other, opposite->cell, other_xi), row.normal)
          : 0.0;
}

/// Open for certain: nothing lies opposite, or more than one of the larger cells away.
bool is_far_from_contact(const Simulation& sim, const ContactRow& row) {
  return !(row.gap < sim.bodies[sim.pairs[row.pair].primary].cut_cells.grid.cell_size);
}

/// What patches with closed points leave at open ones, where they carry nothing, is rounding: zero.
void clear_rounding(const Simulation& sim, std::vector<ContactRow>& rows) {
  if (!sim.scene.recovery.spr_c) return;
  std::vector<double> largest(sim.pairs.size(), 0.0);
  for (const ContactRow& r : rows) largest[r.pair] = std::max(largest[r.pair], std::abs(r.pressure_sprc));
  for (ContactRow& r : rows)
    if (!r.active && std::abs(r.pressure_sprc) < rounding * largest[r.pair]) r.pressure_sprc = 0;
}

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

ContactRow contact_row(const Simulation& sim, int body, int pair, int cell, const Vec3& position, const Vec3& n) {
  const BodyModel& model = sim.bodies[body];
  ContactRow row;
  row.body = body;
  row.pair = pair;
  row.cell = cell;
  row.x = model.cut_cells.grid.to_global(position);
  row.normal = n;
  const Vec3 xi = cell_coordinates(model.cut_cells, cell, position);
  row.stress_raw = raw_stress(sim, body, cell, xi);
  row.stress_spr = recovered_stress(sim, sim.spr[body], body, cell, xi);
  row.stress_sprc = recovered_stress(sim, sim.sprc[body], body, cell, xi);
  row.pressure_raw = pressure(row.stress_raw, n);
  row.pressure_spr = pressure(row.stress_spr, n);
  row.pressure_sprc = pressure(row.stress_sprc, n);
  look_across(sim, cell, xi, row);
  const bool far = is_far_from_contact(sim, row);
  const ContactLink* link = nearest_link(model, cell, position, model.cut_cells.grid.rotation.transpose() * n, pair);
  row.active = link && link->active && !far;
  row.pressure_transmitted = !link ? std::numeric_limits<double>::quiet_NaN() : row.active ? link->pressure : 0.0;
  if (sim.scene.recovery.spr_c && (far || !carries_pressure(sim, body, cell, pair, position, n))) row.pressure_sprc = 0;
  return row;
}

Vec3 displacement(const Simulation& sim, int body, int cell, const Vec3& xi) {
  double u[8][3], N[8];
  corner_displacements(sim, body, cell, u);
  hex_shape(xi.data(), N);
  const CutCells& cut_cells = sim.bodies[body].cut_cells;
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 8; ++a) sum += N[a] * Vec3(u[a][0], u[a][1], u[a][2]);
  return sim.scales.length * (cut_cells.grid.rotation * sum) +
         sim.outer.rigid_parts[body].at(global_position(cut_cells, cell, xi));
}

void add_supports(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                  const Scales& scales, ElasticSystem& system) {
  std::vector<std::vector<SupportTerm>> terms(scene.bodies.size());
  for (const SupportPoint& p : supports) {
    const Mat3& R = system.meshes[p.body].cut_cells->grid.rotation;
    const double stiffness = support_stiffness(scene, bodies[p.body]) * p.weight / (scales.stress * scales.length);
    terms[p.body].push_back({p.cell, p.xi, R.transpose() * p.direction, stiffness, bodies[p.body].is_thin()});
  }
  for (std::size_t b = 0; b < terms.size(); ++b) add_support_terms(system, static_cast<int>(b), terms[b]);
}

void fill_counts(const Simulation& sim, Results& results) {
  results.scene_file = sim.scene.file;
  results.title = sim.scene.title;
  results.unknowns = sim.system.num_dofs();
  for (const BodyModel& body : sim.bodies) {
    const long long active = static_cast<long long>(body.cut_cells.cells.size());
    const long long cut = static_cast<long long>(body.cut_cells.moments.size());
    results.cells.active += active;
    results.cells.cut += cut;
    results.cells.interior += active - cut;
    if (body.cut_cells.num_pruned > 0)
      results.warnings.push_back(std::to_string(body.cut_cells.num_pruned) + " cells of body \"" + body.spec->name +
                                 "\" with a volume fraction below 1e-12 were joined with their neighbours");
  }
  results.outer_iterations = sim.outer.iterations;
  results.linear_iterations = sim.outer.linear_iterations;
  results.outer_residuals = sim.outer.residuals;
  results.active_of_iteration = sim.outer.active_points;
  results.converged = sim.outer.converged;
  results.diagnosis = sim.outer.diagnosis;
  for (const ContactPair& pair : sim.pairs)
    for (const ContactPoint& q : pair.points) results.active_points += q.active;
  const RecoveryCounts& counts = sim.recovery_counts;
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

void fill_body_fields(const Simulation& sim, Results& results) {
  const double energy = sim.scales.stress * std::pow(sim.scales.length, 3);
  double error = 0, solution = 0, exact_error = 0;
  const ReferenceSpec& reference = sim.reference;
  for (int b = 0; b < static_cast<int>(sim.bodies.size()); ++b) {
    ExactStress exact;
    if (!reference.stress_of_body.empty())
      exact = [&reference, b](const Vec3& x) {
        Sym3 s;
        for (int k = 0; k < 6; ++k) s[k] = reference.stress_of_body[b][k](x);
        return s;
      };
    EnergySums sums = estimate_error(sim.system.meshes[b], sim.scales, sim.sprc[b], sim.outer.u, exact);
    error += sums.error;
    solution += sums.solution;
    exact_error += sums.exact_error;
    BodyFields fields;
    fields.name = sim.bodies[b].spec->name;
    fields.cut_cells = &sim.bodies[b].cut_cells;
    fields.material = sim.bodies[b].spec->material;
    fields.displacement = [&sim, b](int cell, const Vec3& xi) { return displacement(sim, b, cell, xi); };
    fields.stress_raw = [&sim, b](int cell, const Vec3& xi) { return raw_stress(sim, b, cell, xi); };
    fields.stress_recovered = [&sim, b](int cell, const Vec3& xi) {
      return recovered_stress(sim, sim.sprc[b], b, cell, xi);
    };
    fields.error_of_cell = std::move(sums.error_of_cell);
    for (double& e : fields.error_of_cell) e = std::sqrt(e * energy);
    if (!sim.patch_states.empty()) fill_patch_states(sim.system.meshes[b], sim.patch_states[b], fields);
    results.bodies.push_back(std::move(fields));
  }
  results.estimated_error = std::sqrt(std::max(error, 0.0) * energy);
  results.estimated_error_relative = std::sqrt(std::max(error, 0.0) / std::max(solution, 1e-300));
  if (!reference.stress_of_body.empty() && exact_error > 0) {
    results.has_effectivity = true;
    results.exact_error = std::sqrt(exact_error * energy);
    results.effectivity = std::sqrt(std::max(error, 0.0) / exact_error);
  }
}

void fill_contact_rows(const Simulation& sim, Results& results) {
  std::vector<int> boundary_point;
  for (int b = 0; b < static_cast<int>(sim.bodies.size()); ++b) {
    const BodyModel& body = sim.bodies[b];
    const BoundaryPoints& boundary = body.cut_cells.boundary;
    std::vector<std::vector<int>> points(num_chunks(boundary.size(), grain));
    std::vector<std::vector<ContactRow>> chunks(num_chunks(boundary.size(), grain));
    parallel_chunks("cgcontact::postprocess::contact_rows", boundary.size(), grain,
                    [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                      for (int p = static_cast<int>(begin); p < static_cast<int>(end); ++p) {
                        int pair = body.boundary.pair_of_point[p];
                        if (pair < 0) pair = pair_of_face(sim, b, p);
                        if (pair < 0 || (body.boundary.pair_of_point[p] < 0 && sim.pairs[pair].spec->automatic))
                          continue;
                        ContactRow row =
                            contact_row(sim, b, pair, boundary.cell[p], boundary.position[p], body.normal(p));
                        row.weight = body.area(p);
                        chunks[chunk].push_back(row);
                        points[chunk].push_back(p);
                      }
                    });
    for (const auto& rows : chunks) results.contact_rows.insert(results.contact_rows.end(), rows.begin(), rows.end());
    for (const auto& part : points) boundary_point.insert(boundary_point.end(), part.begin(), part.end());
  }
  clear_rounding(sim, results.contact_rows);
  mark_touching_rows(sim, boundary_point, results.contact_rows);
}

void fill_support_figures(const Simulation& sim, Results& results) {
  for (const SupportSpec& support : sim.scene.supports)
    results.supports.push_back(
        {sim.scene.bodies[support.face.body].name + "." + support.face.face.name, Vec3::Zero(), "", 0});
  for (std::size_t s = 0; s < sim.supports.size(); ++s)
    if (sim.supports[s].support >= 0)
      results.supports[sim.supports[s].support].force +=
          sim.supports[s].weight * sim.outer.support_stress[s] * sim.supports[s].direction;
}

void fill_balance(const Simulation& sim, Results& results) {
  for (std::size_t b = 0; b < sim.bodies.size(); ++b) {
    BodyBalance balance;
    balance.body = sim.bodies[b].spec->name;
    balance.loads = sim.outer.load_of_body[b];
    for (std::size_t s = 0; s < results.supports.size(); ++s)
      if (sim.scene.supports[s].face.body == static_cast<int>(b)) balance.supports += results.supports[s].force;
    for (std::size_t k = 0; k < results.pairs.size(); ++k) {
      if (sim.pairs[k].spec->first.body == static_cast<int>(b)) balance.contact += results.pairs[k].force_on_first;
      if (sim.pairs[k].spec->second.body == static_cast<int>(b)) balance.contact += results.pairs[k].force_on_second;
    }
    results.balance.push_back(balance);
  }
}

void fill_pressure_errors(const Simulation& sim, Results& results) {
  const Reference reference(sim.scene, sim.reference);
  if (reference.has_stress())
    for (const ContactRow& r : results.contact_rows) {
      const Sym3 exact = reference.stress(r.body, r.x);
      results.stress_errors.push_back({r.body, r.x, frobenius(r.stress_raw - exact), frobenius(r.stress_spr - exact),
                                       frobenius(r.stress_sprc - exact)});
    }
  if (!reference.has_pressure() || results.contact_rows.empty()) return;
  results.pressure_errors = pressure_errors(
      results.contact_rows, [&](const ContactRow& r) { return reference.pressure(r.x); }, sim.reference.zones);
  if (results.pressure_errors.empty()) {
    results.warnings.emplace_back("the reference pressure is zero on all contact faces: there is no error of it");
    return;
  }
  for (const auto& [name, inside] : sim.reference.zones) {
    const auto is_this = [&zone = name](const ZoneError& error) { return error.zone == zone; };
    if (std::none_of(results.pressure_errors.begin(), results.pressure_errors.end(), is_this))
      results.warnings.push_back(fmt::format("reference.zones: \"{}\" contains no point of the contact faces", name));
  }
}

}  // namespace cgcontact
