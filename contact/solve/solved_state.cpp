#include "contact/solve/solved_state.hpp"

#include "contact/groups/contact_system.hpp"
#include "core/base/process/parallel.hpp"
#include "kernels/mesh/mean_dilatation.hpp"

namespace cgcontact {
namespace {

/// Stress in Pa and global axes of one of the three fields at cell coordinates.
Sym3 to_global(const SolvedState& state, int body, const double s[6]) {
  const Mat3& R = state.bodies[body].cut_cells.grid.rotation;
  const Sym3 local = Eigen::Map<const Sym3>(s) * state.scales.stress;
  return voigt(R * tensor(local) * R.transpose());
}

/// Returns the displacements of a cell's corners without the body's rigid motion.
void corner_displacements(const SolvedState& state, int body, int cell, double out[8][3]) {
  corner_values(state.system.meshes[body].cell_nodes[cell], state.outer.u, out);
}

}  // namespace

void SolvedState::make_system(const ExecSpace& exec) {
  for (BodyModel& body : bodies) body.cut_cells.gather_moments();
  scales = make_scales(scene);
  system = make_contact_system(scene, bodies, supports, pairs, scales, exec);
}

void SolvedState::take(OuterResult solution) {
  outer = std::move(solution);
  mean_dilatations.clear();
  for (const BodyMesh& mesh : system.meshes) {
    std::vector<double> means(mesh.law.lambda_of_mean > 0 ? mesh.cell_nodes.size() : 0);
    parallel_for("cgcontact::solved_state::mean_dilatations", means.size(), grain_of_medium, [&](std::size_t cell) {
      double u[8][3];
      corner_values(mesh.cell_nodes[cell], outer.u, u);
      means[cell] = mean_dilatation(mesh, static_cast<int>(cell), u);
    });
    mean_dilatations.push_back(std::move(means));
  }
}

void SolvedState::release_assembly_data() {
  for (BodyModel& body : bodies) body.cut_cells.drop_moments();
  supports = {};
}

Vec3 displacement(const SolvedState& state, int body, int cell, const Vec3& xi) {
  double u[8][3];
  corner_displacements(state, body, cell, u);
  const CutCells& cut_cells = state.bodies[body].cut_cells;
  return state.scales.length * (cut_cells.grid.rotation * interpolate(u, xi)) +
         state.outer.body_motions[body].at(global_position(cut_cells, cell, xi));
}

Sym3 raw_stress(const SolvedState& state, int body, int cell, const Vec3& xi) {
  const BodyMesh& mesh = state.system.meshes[body];
  if (mesh.rigid) return Sym3::Zero();
  double u[8][3], s[6];
  corner_displacements(state, body, cell, u);
  const std::vector<double>& means = state.mean_dilatations[body];
  hex_stress(mesh.law, u, means.empty() ? 0 : means[cell], xi.data(), s, mesh.ring_of(cell));
  for (double& v : s) v *= mesh.stress_factor(cell);
  return to_global(state, body, s) + state.bodies[body].held_back;
}

Sym3 recovered_stress(const SolvedState& state, const RecoveredField& field, int body, int cell, const Vec3& xi) {
  double s[6];
  evaluate_recovered(state.system.meshes[body], field, cell, xi.data(), s);
  return to_global(state, body, s) + state.bodies[body].held_back;
}

std::vector<Sym3> recovered_stress_at_corners(const SolvedState& state, const RecoveredField& field, int body,
                                              const std::vector<int>& cells, const std::vector<signed char>& corners) {
  const BodyMesh& mesh = state.system.meshes[body];
  std::vector<Sym3> stress(cells.size());
  std::vector<int> nodes;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (const int node = mesh.cell_nodes[cells[i]][corners[i]] - mesh.first_node; field.nodes.row(node) < 0) {
      nodes.push_back(node);
      indices.push_back(i);
    }
  std::vector<Coefficients> polynomials(nodes.size());
  if (!nodes.empty()) field.interior->at_all(nodes, polynomials.front().data());
  parallel_for("cgcontact::solved_state::interior", nodes.size(), grain_of_medium, [&](std::size_t i) {
    double s[6];  // a polynomial at its node
    for (int k = 0; k < 6; ++k) s[k] = polynomials[i][num_terms * k];
    stress[indices[i]] = to_global(state, body, s) + state.bodies[body].held_back;
  });
  parallel_for("cgcontact::solved_state::stored", cells.size(), grain_of_medium, [&](std::size_t i) {
    const int a = corners[i];
    if (field.nodes.row(mesh.cell_nodes[cells[i]][a] - mesh.first_node) < 0) return;
    stress[i] = recovered_stress(state, field, body, cells[i], Vec3(a & 1 ? 1 : -1, a & 2 ? 1 : -1, a & 4 ? 1 : -1));
  });
  return stress;
}

}  // namespace cgcontact
