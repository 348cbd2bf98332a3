#include "contact/solve/iterate.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Steps of the springs' rest positions that fall by a ratio between these are taken for a geometric series. Below
/// there is little to gain; above it is a guess.
constexpr double slow = 0.3, without_end = 0.99;

RealView new_values(const char* label, std::size_t size) {
  return RealView(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), size);
}

}  // namespace

std::vector<double> to_host(const RealView& values) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), values);
  return {host.data(), host.data() + host.extent(0)};
}

Iterate::Iterate(const OuterProblem& outer_problem)
    : problem(outer_problem),
      u("cgcontact::iterate::u", problem.system.num_dofs()),
      body_motions(problem.system.meshes, problem.scales),
      floating(problem.bodies, problem.supports, problem.pairs),
      small_zones(problem.bodies, problem.pairs, floating.displacement_driven_pairs(), problem.scene.solver),
      friction(problem),
      support_stress("cgcontact::iterate::support_stress", problem.supports.size()),
      rigid_gap_change("cgcontact::iterate::rigid_gap_change", problem.system.group_rows.size()),
      groups_(make_group_arrays(problem)),
      supports_(make_support_arrays(problem)),
      support_directions_(support_directions(problem)),
      row_directions_(row_directions(problem)),
      entry_index_(indices_of_entries(problem.system.groups)) {
  contact_stress = PointStresses("cgcontact::iterate::contact_stress", groups_.weight.extent(0));
  groups_.lagged = contact_stress.d_view;
  supports_.lagged = support_stress.d_view;
}

void Iterate::forget() {
  Kokkos::deep_copy(u, 0.0);
  body_motions.forget();
  Kokkos::deep_copy(rigid_gap_change, 0.0);
  small_zones.forget();
  friction.forget();
  last_spring_steps_.clear();
  for (PointStresses* values : {&support_stress, &contact_stress}) {
    Kokkos::deep_copy(values->h_view, 0.0);
    values->modify_host();
  }
  for (SupportPoint& p : problem.supports)
    if (p.follows) p.value = 0;
}

/// Supports that have been added come last.
void Iterate::warm_start_from(const Iterate& other) {
  Kokkos::deep_copy(u, other.u);
  body_motions.forget();
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    const BodyMotion& motion = other.body_motions.of_bodies()[b];
    body_motions.move(b, motion.translation, motion.rotation, motion.centre);
  }
  Kokkos::deep_copy(rigid_gap_change, 0.0);
  const auto take = [](PointStresses& to, const PointStresses& from) {
    const std::size_t size = std::min(to.h_view.extent(0), from.h_view.extent(0));
    Kokkos::deep_copy(to.h_view, 0.0);
    for (std::size_t i = 0; i < size; ++i) to.h_view(i) = from.h_view(i);
    to.modify_host();
  };
  take(support_stress, other.support_stress);
  take(contact_stress, other.contact_stress);
  small_zones.forget();
}

void Iterate::set_rigid_motions_aside() {
  body_motions.set_aside(problem.exec, u);
  const RealView at_dofs = new_values("cgcontact::iterate::rigid_at_dofs", row_directions_.body.extent(0));
  cgcontact::rigid_displacements(problem.exec, row_directions_, body_motions.on_device(), at_dofs);
  const GroupRows& rows = problem.system.groups;
  Kokkos::deep_copy(problem.exec, rigid_gap_change, 0.0);
  multiply_rows(problem.exec, rows.row_begin, entry_index_, rows.row_value, at_dofs, 1, rigid_gap_change,
                rigid_gap_change);
  problem.exec.fence();
}

const ContactGroupArrays<MemSpace>& Iterate::groups() const {
  take_state(problem, small_zones, groups_);
  friction.put_into(groups_);
  PointStresses(contact_stress).sync_device();  // shares the memory
  return groups_;
}

const SupportArrays<MemSpace>& Iterate::supports() const {
  take_values(problem, supports_);
  PointStresses(support_stress).sync_device();
  return supports_;
}

RealView Iterate::rigid_displacements() const {
  const RealView moved = new_values("cgcontact::iterate::support_displacements", problem.supports.size());
  cgcontact::rigid_displacements(problem.exec, support_directions_, body_motions.on_device(), moved);
  problem.exec.fence();
  return moved;
}

RealView Iterate::support_displacements() const {
  const RealView moved = rigid_displacements();
  add_displacements(problem.exec, supports_, u, problem.scales.length, moved);
  problem.exec.fence();
  return moved;
}

std::vector<double> Iterate::support_tractions() const {
  const RealView tractions = new_values("cgcontact::iterate::support_tractions", problem.supports.size());
  cgcontact::support_tractions(problem.exec, supports(), support_displacements(), tractions);
  problem.exec.fence();
  return to_host(tractions);
}

RealView Iterate::gap_change_of(const RealView& displacements) const {
  const GroupRows& rows = problem.system.groups;
  const RealView change("cgcontact::iterate::gap_change", rigid_gap_change.size());
  multiply_rows(problem.exec, rows.row_begin, rows.row_dof, rows.row_value, displacements, problem.scales.length,
                change, change);
  problem.exec.fence();
  return change;
}

RealView Iterate::gap_change() const {
  const GroupRows& rows = problem.system.groups;
  const RealView change = new_values("cgcontact::iterate::gap_change", rigid_gap_change.size());
  multiply_rows(problem.exec, rows.row_begin, rows.row_dof, rows.row_value, u, problem.scales.length, rigid_gap_change,
                change);
  problem.exec.fence();
  return change;
}

RealView Iterate::group_forces(bool with_displacement) const {
  const RealView forces = new_values("cgcontact::iterate::group_forces", rigid_gap_change.size());
  const RealView change = with_displacement ? gap_change() : rigid_gap_change;
  cgcontact::group_forces(problem.exec, groups(), change, force_unit(), forces);
  friction.add_coupled_forces(change, force_unit(), forces);
  problem.exec.fence();
  return forces;
}

std::vector<double> Iterate::group_stiffness() const {
  const RealView stiffness = new_values("cgcontact::iterate::group_stiffness", rigid_gap_change.size());
  closed_stiffness(problem.exec, groups(), problem.scales.stress * problem.scales.length, stiffness);
  problem.exec.fence();
  return to_host(stiffness);
}

std::vector<double> Iterate::group_coupling() const {
  std::vector<double> coupling = friction.coupling();
  for (double& c : coupling) c /= problem.scales.stress * problem.scales.length;
  return coupling;
}

void Iterate::close_pressing_points(double fraction) {
  const ContactGroupArrays<MemSpace>& arrays = groups();
  const RealView change = gap_change(), largest = new_values("cgcontact::iterate::largest", change.size());
  largest_pressures(problem.exec, arrays, change, largest);
  problem.exec.fence();
  const std::vector<double> of_groups = to_host(largest);
  const Kokkos::View<char*, MemSpace> may_change("cgcontact::iterate::may_change", of_groups.size());
  const auto host = Kokkos::create_mirror_view(may_change);
  std::size_t first = 0;
  for (const ContactPair& pair : problem.pairs) {
    double most = 0, stiffest = 0;
    for (std::size_t g = 0; g < pair.groups.size(); ++g) {
      most = std::max(most, of_groups[first + g]);
      stiffest = std::max(stiffest, pair.stiffness(pair.groups[g]));
    }
    const bool changes = !pair.bonded() && !(most < fraction * stiffest);
    for (std::size_t g = 0; g < pair.groups.size(); ++g) host(first + g) = changes ? 1 : 0;
    first += pair.groups.size();
  }
  Kokkos::deep_copy(may_change, host);
  close_pressing(problem.exec, arrays, change, may_change);
  problem.exec.fence();
  give_state(problem, arrays);
}

double Iterate::total_force() const {
  double sum = 0;
  for (const double force : group_force(true)) sum += std::abs(force);
  return sum * force_unit();
}

double Iterate::spring_force() const {
  double sum = 0;
  if (!floating.any()) return sum;
  const std::vector<double> moved = to_host(support_displacements());
  for (std::size_t s = 0; s < moved.size(); ++s)
    if (const SupportPoint& p = problem.supports[s]; p.follows)
      sum += std::abs(p.weight * support_stiffness(problem.scene, problem.bodies[p.body], p) * (moved[s] - p.value));
  return sum;
}

void Iterate::update_spring_anchors() {
  const bool any =
      std::any_of(problem.supports.begin(), problem.supports.end(), [](const SupportPoint& p) { return p.follows; });
  if (!any) return;
  const std::vector<double> moved = to_host(support_displacements());
  last_spring_steps_.resize(problem.bodies.size());
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    std::vector<SupportPoint*> springs;
    std::vector<double> step;
    for (std::size_t s = 0; s < moved.size(); ++s)
      if (SupportPoint& p = problem.supports[s]; p.follows && p.body == static_cast<int>(b)) {
        springs.push_back(&p);
        step.push_back(moved[s] - p.value);
      }
    const double length = whole_length_of(step, last_spring_steps_[b]);
    for (std::size_t i = 0; i < springs.size(); ++i) springs[i]->value += length * step[i];
  }
}

/// In steps: 1, or the sum of the geometric series that the last step and this one begin (Aitken).
double Iterate::whole_length_of(const std::vector<double>& step, std::vector<double>& last) {
  double with_last = 0, of_last = 0;
  for (std::size_t i = 0; i < last.size(); ++i) {
    with_last += step[i] * last[i];
    of_last += last[i] * last[i];
  }
  const double ratio = of_last > 0 ? with_last / of_last : 0;
  if (ratio < slow || ratio > without_end) {
    last = step;
    return 1;
  }
  last.clear();
  return 1 / (1 - ratio);
}

}  // namespace cgcontact
