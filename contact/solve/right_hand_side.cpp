#include "contact/solve/right_hand_side.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/mesh/dot.hpp"

namespace cgcontact {
namespace {

/// System units: squares of what is smaller lose the digits that the smallest linear tolerance asks for.
const double min_squarable = std::sqrt(std::numeric_limits<double>::min()) / 1e-15;

}  // namespace

RightHandSide::RightHandSide(const OuterProblem& problem)
    : exec_(problem.exec),
      vector_("cgcontact::right_hand_side::vector", problem.system.num_dofs()),
      touched_(make_touched_nodes(problem)),
      touched_load_("cgcontact::right_hand_side::load", dof_of(touched_.size())),
      force_("cgcontact::right_hand_side::force", dof_of(touched_.size())) {}

void RightHandSide::begin(const std::vector<double>& load, bool keep_scale) {
  if (!keep_scale) kappa_norm_ = 0;
  const auto host = Kokkos::create_mirror_view(vector_);
  const auto at_touched = Kokkos::create_mirror_view(touched_load_);
  const auto nodes = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), touched_.node);
  std::vector<int> index(load.size() / dofs_per_node, -1);
  for (std::size_t t = 0; t < nodes.extent(0); ++t) index[nodes(t)] = static_cast<int>(t);
  square_elsewhere_ = 0;
  for (int i = 0; i < static_cast<int>(load.size()); ++i) {
    host(i) = load[i];
    if (const int t = index[node_of_dof(i)]; t >= 0)
      at_touched(dof_of(t, component_of_dof(i))) = load[i];
    else
      square_elsewhere_ += load[i] * load[i];
  }
  Kokkos::deep_copy(vector_, host);
  Kokkos::deep_copy(touched_load_, at_touched);
}

void RightHandSide::take_rows(const OuterProblem& problem) { touched_ = make_touched_nodes(problem); }

double RightHandSide::norm() const { return std::sqrt(square_elsewhere_ + dot(exec_, force_, force_)); }

bool RightHandSide::underflows() const {
  double largest = 0;
  const RealView vector = vector_;
  Kokkos::parallel_reduce(
      "cgcontact::right_hand_side::largest", Kokkos::RangePolicy<ExecSpace>(exec_, 0, vector.extent(0)),
      KOKKOS_LAMBDA(const std::size_t i, double& most) { most = std::max(most, std::abs(vector(i))); },
      Kokkos::Max<double>(largest));
  return largest > 0 && largest < min_squarable;
}

void RightHandSide::assemble(const Iterate& iterate) {
  const RealView of_stress("cgcontact::right_hand_side::of_stress", iterate.problem.supports.size()),
      of_value("cgcontact::right_hand_side::of_value", iterate.problem.supports.size());
  const SupportArrays<MemSpace>& supports = iterate.supports();
  support_amounts(exec_, supports, iterate.rigid_displacements(), iterate.force_unit(), of_stress, of_value);
  Kokkos::deep_copy(exec_, force_, touched_load_);
  add_support_forces(exec_, touched_, supports, of_stress, force_);
  // The terms kappa E/h (prescribed displacement or gap) exceed the real forces by orders and nearly cancel against the
  // solution's; they serve only without a known stress.
  const double forces = norm();
  add_contact_forces(exec_, touched_, iterate.group_forces(false), force_);
  add_support_forces(exec_, touched_, supports, of_value, force_);
  // Without forces (no load yet, or a motion without stress) the scale is rounding of the kappa terms before rigid
  // motions were set aside.
  kappa_norm_ = std::max(kappa_norm_, norm());
  force_norm_ = forces > 0 ? std::max(forces, no_force * kappa_norm_) : 1e-2 * kappa_norm_;
  put_at_nodes(exec_, touched_, force_, vector_);
  exec_.fence();
}

double RightHandSide::assemble_groups(const std::vector<double>& forces) {
  const RealView amounts("cgcontact::right_hand_side::groups", forces.size());
  const auto host = Kokkos::create_mirror_view(amounts);
  for (std::size_t g = 0; g < forces.size(); ++g) host(g) = forces[g];
  Kokkos::deep_copy(amounts, host);
  Kokkos::deep_copy(vector_, 0.0);
  Kokkos::deep_copy(force_, 0.0);
  add_contact_forces(exec_, touched_, amounts, force_);
  put_at_nodes(exec_, touched_, force_, vector_);
  exec_.fence();
  return std::sqrt(dot(exec_, force_, force_));
}

}  // namespace cgcontact
