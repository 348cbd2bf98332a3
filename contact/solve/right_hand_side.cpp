#include "contact/solve/right_hand_side.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/ranks.hpp"

namespace cgcontact {
namespace {

/// Forces below this part of the kappa terms are rounding.
constexpr double no_force = 1e-10;

}  // namespace

RightHandSide::RightHandSide(const OuterProblem& problem)
    : vector_("cgcontact::right_hand_side", problem.system.num_dofs()), place_(problem.system.num_nodes, -1) {
  const auto touch = [&](int node) {
    if (place_[node] >= 0) return;
    place_[node] = static_cast<int>(touched_.size());
    touched_.push_back(node);
  };
  for (const SupportPoint& p : problem.supports)
    if (!p.by_plane_strain)
      for (const int node : problem.system.meshes[p.body].cell_nodes[p.cell]) touch(node);
  for (const GroupRow& row : problem.system.group_rows)
    for (const auto& [dof, value] : row.entries) touch(node_of_dof(dof));
}

void RightHandSide::begin(const std::vector<double>& load, bool keep_scale) {
  if (!keep_scale) kappa_norm_ = 0;
  touched_load_.resize(dofs_per_node * touched_.size());
  square_elsewhere_ = 0;
  auto host = Kokkos::create_mirror_view(vector_);
  for (int i = 0; i < static_cast<int>(load.size()); ++i) {
    host(i) = load[i];
    if (place_[node_of_dof(i)] >= 0)
      touched_load_[place_of(i)] = load[i];
    else
      square_elsewhere_ += load[i] * load[i];
  }
  Kokkos::deep_copy(vector_, host);
}

double RightHandSide::norm(const std::vector<double>& at_touched) const {
  double sum = square_elsewhere_;
  for (const double x : at_touched) sum += x * x;
  return std::sqrt(sum);
}

/// Forces of the lagged stresses at supports, and those of their prescribed displacements; of several ranks each
/// computes some of them.
void RightHandSide::add_supports(const Iterate& iterate, std::vector<double>& stress_forces,
                                 std::vector<double>& values) const {
  const OuterProblem& problem = iterate.problem;
  const double length = problem.scales.length, area_scale = length * length;
  const auto [begin, end] = share_out(problem.supports.size());
  for (std::size_t s = begin; s < end; ++s) {
    const SupportPoint& p = problem.supports[s];
    if (p.by_plane_strain) continue;
    const Vec3 d = problem.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
    const double stress_force = iterate.support_stress[s] * p.weight / area_scale;
    const double value = p.value - iterate.rigid_displacement(p);
    const double value_force = iterate.to_stiffness(iterate.support_stiffness(p), p.weight) * value / length;
    displacement_row(problem.system.meshes[p.body].cell_nodes[p.cell], p.xi, d, [&](int dof, double share) {
      stress_forces[place_of(dof)] += share * stress_force;
      values[place_of(dof)] += share * value_force;
    });
  }
  sum_over_ranks(stress_forces.data(), stress_forces.size());
  sum_over_ranks(values.data(), values.size());
}

void RightHandSide::assemble(const Iterate& iterate) {
  std::vector<double> f(touched_load_.size(), 0.0), values(f);
  if (is_first_rank()) f = touched_load_;
  add_supports(iterate, f, values);
  // The terms kappa E/h (prescribed displacement or gap) are larger than the real forces by orders and nearly cancel
  // against the solution's; they serve only while no stress is known.
  const double forces = norm(f);
  const std::vector<double> force = iterate.group_force(false);
  for (std::size_t row = 0; row < force.size(); ++row)
    for (const auto& [dof, value] : iterate.problem.system.group_rows[row].entries)
      f[place_of(dof)] += value * force[row];
  for (std::size_t i = 0; i < f.size(); ++i) f[i] += values[i];
  // Without forces (no load yet, or a motion without stress) rounding of the kappa terms is all there is to measure by:
  // what they were before rigid motions were set aside.
  kappa_norm_ = std::max(kappa_norm_, norm(f));
  force_norm_ = forces > 0 ? std::max(forces, no_force * kappa_norm_) : 1e-2 * kappa_norm_;
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), vector_);
  for (std::size_t t = 0; t < touched_.size(); ++t)
    for (int i = 0; i < dofs_per_node; ++i) host(dof_of(touched_[t], i)) = f[dofs_per_node * t + i];
  Kokkos::deep_copy(vector_, host);
}

}  // namespace cgcontact
