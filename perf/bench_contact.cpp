/// Kernels over contact points, groups and supports (contact/kernels), on the contact of scenes/two_solids_3d.toml;
/// sizes are n of the scene. About half of the points are closed.
#include <cmath>
#include <map>
#include <memory>

#include "contact/groups/group_rows.hpp"
#include "contact/kernels/row_kernels.hpp"
#include "contact/solve/iterate.hpp"
#include "kernels/mesh/interpolate.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

struct Contact {
  SceneProblem problem;
  Iterate iterate;
  ContactGroupArrays<MemSpace> groups;
  TouchedNodes<MemSpace> touched;
  RealView u, change, out;
  double num_points, num_groups, num_entries, num_dofs;

  explicit Contact(int n, const std::vector<std::string>& more = {})
      : problem("scenes/two_solids_3d.toml", with_size(n, more)),
        iterate(outer_problem()),
        touched(make_touched_nodes(iterate.problem)),
        u(random_vector(problem.system.num_dofs(), 3)) {
    iterate.forget();
    const auto stress = iterate.contact_stress.h_view;
    for (std::size_t q = 0; q < stress.extent(0); ++q) stress(q) = std::sin(1.7 * static_cast<double>(q));
    iterate.contact_stress.modify_host();
    ContactPoints& points = problem.simulation.state.pairs[0].points;
    for (std::size_t q = 0; q < points.size(); ++q) points.set_active(q, stress(q) > 0);
    groups = iterate.groups();
    change = iterate.gap_change_of(u);
    out = RealView("bench_contact::out", change.size());
    num_points = static_cast<double>(groups.weight.size());
    num_groups = groups.num_groups();
    num_entries = static_cast<double>(problem.system.groups.row_value.size());
    num_dofs = static_cast<double>(problem.system.groups.dof_list.size());
  }

  static std::vector<std::string> with_size(int n, std::vector<std::string> overrides) {
    overrides.push_back("n=" + std::to_string(n));
    return overrides;
  }
  OuterProblem outer_problem() {
    SolvedState& s = problem.simulation.state;
    return {s.scene, s.bodies, s.pairs, s.supports, s.system, s.scales, ExecSpace()};
  }
  void add_figures(Kernel& k) const { k.figures = {{"groups", num_groups}, {"entries", num_entries}}; }
};

/// Largest difference to host values, relative to the largest of these.
template <class View, class T>
double difference(const View& view, const std::vector<T>& plain) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
  double error = 0, largest = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    error = std::max(error, std::abs(static_cast<double>(host(i)) - static_cast<double>(plain[i])));
    largest = std::max(largest, std::abs(static_cast<double>(plain[i])));
  }
  return plain.empty() ? 1 : error / largest;
}

/// Per point weight, p* and state are read and 4 flop made; per group its law, first point, gaps and zone flag are read
/// and a force written.
Kernel forces(int n) {
  auto c = std::make_shared<Contact>(n);
  group_forces(ExecSpace(), c->groups, c->change, 1, c->out);
  ExecSpace().fence();
  std::vector<double> plain;
  std::size_t g = 0, q = 0;
  const auto change = to_host(c->change);
  const auto stress = c->iterate.contact_stress.h_view;
  for (const ContactPair& pair : c->problem.simulation.state.pairs)
    for (const ContactGroup& group : pair.groups) {
      double sum = 0;
      for (int p = group.first_point; p < group.last_point; ++p, ++q)
        if (pair.points.active(p))
          sum += pair.points.weight(p) * (stress(q) * c->problem.simulation.state.scales.stress -
                                          pair.stiffness(group) * (group.initial_gap + change[g]));
      plain.push_back(sum);
      ++g;
    }
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {4 * c->num_points, 17 * c->num_points + (4 + 16 + 8 + 8 + 1 + 16) * c->num_groups};
  k.error = difference(c->out, plain), k.tolerance = 1e-13, k.against = "a plain loop";
  k.run = [c] {
    group_forces(ExecSpace(), c->groups, c->change, 1, c->out);
    ExecSpace().fence();
  };
  c->add_figures(k);
  return k;
}

/// Per point p* is read and the state written (17 bytes with the write-allocate of the latter), 3 flop; per group its
/// law, first point, gaps and flag.
Kernel active_set(int n) {
  auto c = std::make_shared<Contact>(n);
  const Kokkos::View<char*, MemSpace> all("bench_contact::all", c->groups.num_groups());
  Kokkos::deep_copy(all, 1);
  close_pressing(ExecSpace(), c->groups, c->change, all);
  ExecSpace().fence();
  std::vector<char> plain;
  std::size_t g = 0;
  const auto change = to_host(c->change);
  const auto stress = c->iterate.contact_stress.h_view;
  for (const ContactPair& pair : c->problem.simulation.state.pairs)
    for (const ContactGroup& group : pair.groups) {
      for (int p = group.first_point; p < group.last_point; ++p)
        plain.push_back(stress(plain.size()) * c->problem.simulation.state.scales.stress -
                            pair.stiffness(group) * (group.initial_gap + change[g]) >
                        0);
      ++g;
    }
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {3 * c->num_points, 10 * c->num_points + (4 + 16 + 8 + 8 + 1) * c->num_groups};
  k.error = difference(c->groups.active, plain), k.tolerance = 0, k.against = "a plain loop";
  k.run = [c, all] {
    close_pressing(ExecSpace(), c->groups, c->change, all);
    ExecSpace().fence();
  };
  c->add_figures(k);
  return k;
}

/// Rows times displacements: per entry a coefficient and a number are read, 2 flop; each touched displacement once; per
/// group first entry and start are read, the gap written.
Kernel gaps(int n) {
  auto c = std::make_shared<Contact>(n);
  const GroupRows& rows = c->problem.system.groups;
  const RealView zero("bench_contact::zero", c->change.size());
  const auto run = [c, zero, &rows] {
    multiply_rows(ExecSpace(), rows.row_begin, rows.row_dof, rows.row_value, c->u, 1, zero, c->out);
    ExecSpace().fence();
  };
  run();
  std::vector<double> plain;
  const auto u = to_host(c->u);
  for (const GroupRow& row : c->problem.system.group_rows) {
    double sum = 0;
    for (const auto& [dof, value] : row.entries) sum += value * u[dof];
    plain.push_back(sum);
  }
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {2 * c->num_entries, 12 * c->num_entries + 8 * c->num_dofs + 28 * c->num_groups};
  k.error = difference(c->out, plain), k.tolerance = 1e-13, k.against = "a plain loop";
  k.run = run;
  c->add_figures(k);
  return k;
}

/// The transpose: per entry a coefficient and a number are read, 2 flop; each group's force once; per touched degree of
/// freedom its first entry is read and the force read and written.
Kernel nodal_forces(int n) {
  auto c = std::make_shared<Contact>(n);
  const RealView force("bench_contact::force", dof_of(c->touched.size()));
  add_contact_forces(ExecSpace(), c->touched, c->change, force);
  ExecSpace().fence();
  const auto nodes = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), c->touched.node);
  std::map<int, std::size_t> slot;
  for (std::size_t t = 0; t < nodes.extent(0); ++t) slot[nodes(t)] = t;
  std::vector<double> plain(force.size(), 0.0);
  const auto amount = to_host(c->change);
  for (std::size_t g = 0; g < amount.size(); ++g)
    for (const auto& [dof, value] : c->problem.system.group_rows[g].entries)
      plain[dof_offset(slot.at(node_of_dof(dof)), component_of_dof(dof))] += value * amount[g];
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {2 * c->num_entries, 12 * c->num_entries + 8 * c->num_groups + 20.0 * static_cast<double>(force.size())};
  k.error = difference(force, plain), k.tolerance = 1e-13, k.against = "a plain loop";
  k.run = [c, force] {
    add_contact_forces(ExecSpace(), c->touched, c->change, force);
    ExecSpace().fence();
  };
  c->add_figures(k);
  return k;
}

/// Rows made from the points. Per point two cells, cell coordinates and node numbers, a direction and a weight are read
/// (16 + 64 + 56 + 8 bytes); entries are written. Flop: 2 x 8 shape functions of 7 and 16 x 6 for the shares.
Kernel rows(int n) {
  auto c = std::make_shared<Contact>(n);
  const SolvedState& state = c->problem.simulation.state;
  const auto found = make_group_rows(ExecSpace(), state.pairs, state.bodies, state.system);
  double error = 0, largest = 0;
  std::size_t g = 0;
  for (const ContactPair& pair : state.pairs)
    for (const ContactGroup& group : pair.groups) {
      std::map<int, double> plain;
      for (int p = group.first_point; p < group.last_point; ++p) {
        const ContactPoint point = pair.points[p];
        const auto add = [&](int body, int cell, const Vec3& xi, const Vec3& along) {
          const Vec3 local = state.bodies[body].cut_cells.grid.rotation.transpose() * along;
          displacement_row(state.system.meshes[body].cell_nodes[cell], xi, local,
                           [&](int dof, double value) { plain[dof] += value * point.weight / group.area; });
        };
        add(pair.primary, point.primary_cell, point.primary_xi, -point.direction);
        add(pair.secondary, point.secondary_cell, point.secondary_xi, point.direction);
      }
      for (const auto& [dof, value] : found[g].entries) plain[dof] -= value;
      for (const auto& [dof, value] : plain) error = std::max(error, std::abs(value));
      for (const auto& [dof, value] : found[g].entries) largest = std::max(largest, std::abs(value));
      ++g;
    }
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {(2 * 8 * 7 + 16 * 6) * c->num_points, 144 * c->num_points + 24 * c->num_entries};
  k.error = error / largest, k.tolerance = 1e-13, k.against = "plain loops";
  k.run = [c] {
    const SolvedState& s = c->problem.simulation.state;
    benchmark::DoNotOptimize(make_group_rows(ExecSpace(), s.pairs, s.bodies, s.system));
  };
  c->add_figures(k);
  return k;
}

/// Friction made linear about the present slip. Per point weight, bound, lagged shear and reference are read (48 bytes)
/// and some 40 flop made; per group slip, law, frame and old forces are read, and the new ones written.
Kernel friction(int n) {
  auto c = std::make_shared<Contact>(n, std::vector<std::string>{"contact.0.friction=0.3"});
  Friction& friction = c->iterate.friction;
  const FrictionArrays<MemSpace>& arrays = friction.arrays();
  const auto change = Kokkos::subview(c->change, std::pair(friction.first_row(), static_cast<int>(c->change.size())));
  const auto shear = friction.stress.h_view;
  for (std::size_t q = 0; q < shear.extent(0); ++q)
    for (int i = 0; i < 2; ++i) shear(q, i) = 0.2 * std::sin(0.7 * static_cast<double>(q) + i);
  friction.stress.modify_host();
  friction.stress.sync_device();
  take_pressures(ExecSpace(), c->groups, arrays, c->change);
  set_bounds(ExecSpace(), c->groups, arrays, ShearBound::by_pressure);
  const auto run = [c, arrays, change] {
    linearise_friction(ExecSpace(), c->groups, arrays, c->change, RealView(change));
    ExecSpace().fence();
  };
  run();
  const auto host = [](const auto& view) { return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view); };
  const auto linear = host(arrays.linear);
  const auto frame = host(arrays.frame);
  const auto bound = host(arrays.bound);
  const auto slips = host(change);
  const SolvedState& state = c->problem.simulation.state;
  double error = 0, largest = 0;
  std::size_t f = 0, q = 0;
  for (const ContactPair& pair : state.pairs)
    for (const ContactGroup& group : pair.groups) {
      const double slip[2] = {slips(2 * f), slips(2 * f + 1)}, none[2] = {0, 0};
      Eigen::Vector2d force(0, 0);
      for (int p = group.first_point; p < group.last_point; ++p, ++q) {
        const double lagged[2] = {shear(q, 0) * state.scales.stress, shear(q, 1) * state.scales.stress};
        const TangentialContact law(pair.stiffness(group), lagged, slip, none);
        if (bound(q) > 0)
          force += pair.points.weight(p) * law.carried_fraction(bound(q)) * Eigen::Vector2d(law.z[0], law.z[1]);
      }
      const Eigen::Vector2d first(frame(f).cosine, frame(f).sine), second(-frame(f).sine, frame(f).cosine);
      error = std::max({error, std::abs(linear(2 * f).force - first.dot(force)),
                        std::abs(linear(2 * f + 1).force - second.dot(force))});
      largest = std::max(largest, force.norm());
      ++f;
    }
  Kernel k;
  k.unit = "points", k.items = c->num_points;
  k.cost = {40 * c->num_points, 48 * c->num_points + 180 * static_cast<double>(f)};
  k.error = error / largest, k.tolerance = 1e-13, k.against = "a plain loop";
  k.run = run;
  c->add_figures(k);
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("contact/forces", forces, {{4}, {32}});
    add("contact/active_set", active_set, {{4}, {32}});
    add("contact/gaps", gaps, {{4}, {32}});
    add("contact/nodal_forces", nodal_forces, {{4}, {32}});
    add("contact/rows", rows, {{4}, {32}});
    add("contact/friction", friction, {{4}, {32}});
  });
}
