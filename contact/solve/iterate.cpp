#include "contact/solve/iterate.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

/// Groups per chunk of the parallel loops.
constexpr std::size_t grain = 512;
/// Steps of the springs' rest positions that fall by a ratio between these are taken for a geometric series. Below
/// there is little to gain; above it would be hardly more than a guess.
constexpr double slow = 0.3, without_end = 0.99;

}  // namespace

RealView::HostMirror host_copy(const RealView& u) {
  auto host = Kokkos::create_mirror_view(u);
  Kokkos::deep_copy(host, u);
  return host;
}

Iterate::Iterate(const OuterProblem& outer_problem)
    : problem(outer_problem),
      u("cgcontact::iterate::u", problem.system.num_dofs()),
      rigid_parts(problem.system.meshes, problem.scales),
      floating(problem.bodies, problem.supports, problem.pairs),
      small_zones(problem.bodies, problem.pairs, floating.led_pairs(), problem.scene.solver) {}

void Iterate::forget() {
  Kokkos::deep_copy(u, 0.0);
  rigid_parts.forget();
  rigid_gap_change.assign(problem.system.group_rows.size(), 0.0);
  support_stress.assign(problem.supports.size(), 0.0);
  small_zones.forget();
  last_spring_steps_.clear();
  contact_stress.clear();
  for (const ContactPair& pair : problem.pairs) contact_stress.emplace_back(pair.points.size(), 0.0);
  for (SupportPoint& p : problem.supports)
    if (p.follows) p.value = 0;
}

void Iterate::take_over(const Iterate& other) {
  Kokkos::deep_copy(u, other.u);
  rigid_parts.forget();
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    const RigidPart& part = other.rigid_parts.of_bodies()[b];
    rigid_parts.move(b, part.translation, part.rotation, part.centre);
  }
  rigid_gap_change.assign(problem.system.group_rows.size(), 0.0);
  support_stress = other.support_stress;
  support_stress.resize(problem.supports.size(), 0.0);
  contact_stress = other.contact_stress;
  small_zones.forget();
}

void Iterate::set_rigid_parts_aside() {
  rigid_parts.set_aside(u);
  const std::vector<GroupRow>& rows = problem.system.group_rows;
  parallel_for("cgcontact::iterate::rigid_gap_change", rows.size(), grain, [&](std::size_t r) {
    double sum = 0;
    for (const auto& [dof, value] : rows[r].entries) sum += value * rigid_parts.at_dof(dof);
    rigid_gap_change[r] = sum;
  });
}

double Iterate::support_stiffness(const SupportPoint& p) const {
  return cgcontact::support_stiffness(problem.scene, problem.bodies[p.body], p);
}

double Iterate::rigid_displacement(const SupportPoint& p) const {
  return p.direction.dot(
      rigid_parts.of_bodies()[p.body].at(global_position(problem.bodies[p.body].cut_cells, p.cell, p.xi)));
}

double Iterate::displacement_of(const SupportPoint& p, const RealView::HostMirror& host_u) const {
  const Vec3 d = problem.bodies[p.body].cut_cells.grid.rotation.transpose() * p.direction;
  double displacement = rigid_displacement(p) / problem.scales.length;
  displacement_row(problem.system.meshes[p.body].cell_nodes[p.cell], p.xi, d,
                   [&](int dof, double coefficient) { displacement += coefficient * host_u(dof); });
  return displacement * problem.scales.length;
}

std::vector<double> Iterate::support_tractions() const {
  const auto host_u = host_copy(u);
  std::vector<double> tractions;
  for (std::size_t s = 0; s < problem.supports.size(); ++s) {
    const SupportPoint& p = problem.supports[s];
    tractions.push_back(support_stress[s] * problem.scales.stress -
                        support_stiffness(p) * (displacement_of(p, host_u) - p.value));
  }
  return tractions;
}

std::vector<double> Iterate::group_gap_change() const {
  const auto host_u = host_copy(u);
  std::vector<double> change;
  for (const GroupRow& row : problem.system.group_rows) {
    double sum = 0;
    for (const auto& [dof, value] : row.entries) sum += value * host_u(dof);
    change.push_back(sum * problem.scales.length + rigid_gap_change[change.size()]);
  }
  return change;
}

std::vector<double> Iterate::group_force(bool with_displacement) const {
  std::vector<double> forces;
  const std::vector<double> change = with_displacement ? group_gap_change() : rigid_gap_change;
  for (std::size_t k = 0; k < problem.pairs.size(); ++k) {
    const ContactPair& pair = problem.pairs[k];
    for (const ContactGroup& g : pair.groups) {
      if (small_zones.has(forces.size())) {
        const double force = small_zones.force(forces.size(), g.initial_gap + change[forces.size()]);
        forces.push_back(force / force_unit());
        continue;
      }
      const double gap = g.initial_gap + change[forces.size()];
      double force = 0;
      for (int q = g.first_point; q < g.last_point; ++q)
        if (pair.points.active(q))
          force +=
              pair.points.weight(q) * pair.law(g).closed_pressure(contact_stress[k][q] * problem.scales.stress, gap);
      forces.push_back(force / force_unit());
    }
  }
  return forces;
}

std::vector<double> Iterate::group_stiffness() const {
  std::vector<double> stiffness;
  for (const ContactPair& pair : problem.pairs)
    for (const ContactGroup& g : pair.groups) {
      if (small_zones.has(stiffness.size())) {
        stiffness.push_back(small_zones.stiffness(stiffness.size()) / (problem.scales.stress * problem.scales.length));
        continue;
      }
      double area = 0;
      for (int q = g.first_point; q < g.last_point; ++q)
        if (pair.points.active(q)) area += pair.points.weight(q);
      stiffness.push_back(to_stiffness(pair.stiffness(g), area));
    }
  return stiffness;
}

double Iterate::total_force() const {
  double sum = 0;
  for (const double force : group_force(true)) sum += std::abs(force);
  return sum * problem.scales.stress * problem.scales.length * problem.scales.length;
}

double Iterate::spring_force() const {
  double sum = 0;
  if (!floating.any()) return sum;
  const auto host_u = host_copy(u);
  for (const SupportPoint& p : problem.supports)
    if (p.follows) sum += std::abs(p.weight * support_stiffness(p) * (displacement_of(p, host_u) - p.value));
  return sum;
}

void Iterate::let_springs_follow() {
  const bool any =
      std::any_of(problem.supports.begin(), problem.supports.end(), [](const SupportPoint& p) { return p.follows; });
  if (!any) return;
  const auto host_u = host_copy(u);
  last_spring_steps_.resize(problem.bodies.size());
  for (std::size_t b = 0; b < problem.bodies.size(); ++b) {
    std::vector<SupportPoint*> springs;
    std::vector<double> step;
    for (SupportPoint& p : problem.supports)
      if (p.follows && p.body == static_cast<int>(b)) {
        springs.push_back(&p);
        step.push_back(displacement_of(p, host_u) - p.value);
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
