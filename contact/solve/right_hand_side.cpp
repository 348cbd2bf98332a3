#include "contact/solve/right_hand_side.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Forces below this part of the kappa terms are rounding.
constexpr double no_force = 1e-10;

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// Forces of the lagged stresses at supports, and those of their prescribed displacements.
void add_supports(const Iterate& iterate, std::vector<double>& stress_forces, std::vector<double>& values) {
  const OuterProblem& problem = iterate.problem;
  const double length = problem.scales.length, area_scale = length * length;
  for (std::size_t s = 0; s < problem.supports.size(); ++s) {
    const SupportPoint& p = problem.supports[s];
    if (p.by_plane_strain) continue;
    const Vec3 d = problem.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
    const double stress_force = iterate.support_stress[s] * p.weight / area_scale;
    const double value = p.value - iterate.rigid_displacement(p);
    const double value_force = iterate.to_stiffness(iterate.support_stiffness(p), p.weight) * value / length;
    displacement_row(problem.system.meshes[p.body].cell_nodes[p.cell], p.xi, d, [&](int dof, double share) {
      stress_forces[dof] += share * stress_force;
      values[dof] += share * value_force;
    });
  }
}

}  // namespace

void RightHandSide::assemble(const Iterate& iterate) {
  std::vector<double> f = iterate.load, values(iterate.load.size(), 0.0);
  add_supports(iterate, f, values);
  // The terms kappa E/h (prescribed displacement or gap) are larger than the real forces by orders and nearly cancel
  // against the solution's; they serve only while no stress is known.
  const double forces = norm(f);
  const std::vector<double> force = iterate.group_force(false);
  for (std::size_t row = 0; row < force.size(); ++row)
    for (const auto& [dof, value] : iterate.problem.system.group_rows[row].entries) f[dof] += value * force[row];
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += values[i];
  // Without forces (no load yet, or a motion without stress) rounding of the kappa terms is all there is to measure by:
  // what they were before rigid motions were set aside.
  kappa_norm_ = std::max(kappa_norm_, norm(f));
  force_norm_ = forces > 0 ? std::max(forces, no_force * kappa_norm_) : 1e-2 * kappa_norm_;
  auto host = Kokkos::create_mirror_view(vector_);
  for (std::size_t i = 0; i < f.size(); ++i) host(i) = f[i];
  Kokkos::deep_copy(vector_, host);
}

}  // namespace cgcontact
