#include "contact/results/figures/pair_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/checks/condition_checks.hpp"
#include "contact/model/around_axis.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

/// Fractions of the largest pressure: less is the end of a zone, or where the pressure is that small by itself (a zone
/// pressed less than another of the same pair); less than `no_pressure` is none. Fraction of the transmitted pressure
/// above which a small one is so by itself.
constexpr double end_of_zone = 0.01, no_pressure = rounding, little_by_itself = 0.5;

/// Active cells of a body within a cell, the larger one of both bodies' there, from closed points of a pair.
std::vector<char> cells_near_closed(const SolvedState& state, const ContactPair& pair, int body) {
  const CutCells& cut_cells = state.bodies[body].cut_cells;
  std::map<int, std::vector<int>> closed;  // by the number of cells
  for (const ContactPoint& q : pair.points) {
    if (!q.active) continue;
    const int cell = body == pair.primary ? q.primary_cell : q.secondary_cell;
    const double ratio = pair.groups[q.group].larger_cell / cut_cells.h(cell);
    closed[static_cast<int>(std::ceil(ratio - rounding))].push_back(cell);
  }
  std::vector<char> near(cut_cells.cells.size(), 0);
  for (auto& [reach, cells] : closed) mark_cells_around(cut_cells, cells, reach, near);
  return near;
}

/// N, the magnitudes of the forces of all groups of a pair.
std::vector<double> forces_of_pairs(const SolvedState& state) {
  std::vector<double> forces;
  std::size_t group = 0;
  for (const ContactPair& pair : state.pairs) {
    double sum = 0;
    for (std::size_t g = 0; g < pair.groups.size(); ++g) sum += std::abs(state.outer.group_force[group++]);
    forces.push_back(force_unit(state) * sum);
  }
  return forces;
}

/// N, the magnitudes of all that acts on the bodies.
double forces_of_scene(const SolvedState& state, const std::vector<double>& of_pairs) {
  double sum = 0;
  for (const double force : of_pairs) sum += force;
  for (const Vec3& load : state.outer.load_of_body) sum += load.norm();
  for (std::size_t s = 0; s < state.supports.size(); ++s)
    sum += std::abs(state.supports[s].weight * state.outer.support_stress[s]);
  return sum;
}

/// Sums of nodal forces on the primary and the secondary body of a pair, N, N m about the origin.
struct PairForces {
  Vec3 force[2] = {Vec3::Zero(), Vec3::Zero()}, moment[2] = {Vec3::Zero(), Vec3::Zero()};

  /// Adds those of one row of the system's groups; of_row: N.
  void add_row(const SolvedState& state, const ContactPair& pair, std::size_t row, double of_row) {
    for (const auto& [dof, value] : state.system.group_rows[row].entries) {
      const int node = node_of_dof(dof);
      const BodyMesh& primary = state.system.meshes[pair.primary];
      const bool is_primary = node >= primary.first_node && node < primary.first_node + primary.num_nodes;
      const int body = is_primary ? pair.primary : pair.secondary, side = is_primary ? 0 : 1;
      const Grid& grid = state.bodies[body].cut_cells.grid;
      const BodyMesh& mesh = state.system.meshes[body];
      const Vec3 f = of_row * value * grid.rotation.col(component_of_dof(dof));
      force[side] += f;
      moment[side] += grid.to_global(mesh.node_position(node - mesh.first_node)).cross(f);
    }
  }
  /// tangent: number of the row among those of the friction of all pairs.
  void add_friction(const SolvedState& state, const ContactPair& pair, std::size_t tangent) {
    add_row(state, pair, state.outer.group_force.size() + tangent,
            force_unit(state) * state.outer.friction_force[tangent]);
  }
};

/// Adds force and moment on both bodies of a pair, and where the force acts, by the nodal forces of its groups, which
/// act in the discrete equilibrium. `row`: number of its first group, `tangent`: of its first row of friction among
/// those; `magnitude`: sum of its groups' forces.
void add_forces(const SolvedState& state, const ContactPair& pair, std::size_t row, std::size_t tangent,
                double magnitude, PairFigures& figures) {
  // A bonded pair may pull here and press there: the centre of its area.
  Vec3 centre = Vec3::Zero();
  double total = 0;
  PairForces sums;
  for (const ContactGroup& group : pair.groups) {
    const double group_force = force_unit(state) * state.outer.group_force[row];
    sums.add_row(state, pair, row, group_force);
    for (int i = 0; i < pair.num_tangents; ++i, ++tangent) sums.add_friction(state, pair, tangent);
    for (int q = group.first_point; q < group.last_point; ++q)
      centre += (pair.bonded() ? group.area : group_force) * pair.points.weight(q) / group.area * pair.points.x(q);
    total += pair.bonded() ? group.area : group_force;
    ++row;
  }
  const BodySpec& spec = *state.bodies[pair.primary].spec;
  for (int side = 0; side < 2; ++side) sum_around_axis(spec, sums.force[side], &sums.moment[side]);
  sum_around_axis(spec, centre);
  for (Vec3& f : sums.force) f = without_rounding(f, magnitude);  // of forces that add up to none (a shrink fit)
  const int first = pair.spec->first.body == pair.primary ? 0 : 1;
  figures.force_on_first = sums.force[first];
  figures.force_on_second = sums.force[1 - first];
  figures.moment_on_first = sums.moment[first];
  figures.moment_on_second = sums.moment[1 - first];
  if (total > 0) figures.centre = centre / total;
}

/// Adds the largest pressure, and the area of the contact zone: mean of both bodies, of the elastic one beside a rigid
/// one, which often has larger cells and reaches beyond the zone. Closed points make up whole
/// groups; the recovered pressure ends where the edge was found (sphere on block, ten cells over the contact radius:
/// radius from closed points 2 to 3 % too small, from this within 0.2 %).
void add_zone(const SolvedState& state, int k, const std::vector<ContactRow>& rows, PairFigures& figures) {
  for (const ContactRow& r : rows)
    if (r.pair == k && r.touching) figures.max_pressure = std::max(figures.max_pressure, r.pressure_sprc);
  constexpr double equal = 1 - rounding;  // of equal ones the first, whatever the rounding
  const auto largest = std::find_if(rows.begin(), rows.end(), [&](const ContactRow& r) {
    return r.pair == k && r.touching && r.pressure_sprc > equal * figures.max_pressure;
  });
  if (figures.max_pressure > 0 && largest != rows.end()) figures.max_pressure_at = largest->x;
  const ContactPair& pair = state.pairs[k];
  const auto is_rigid = [&](int body) { return state.bodies[body].spec->rigid(); };
  if (state.scene.recovery.spr_c && !pair.bonded()) {
    const bool both = !is_rigid(pair.primary) && !is_rigid(pair.secondary);
    for (const ContactRow& r : rows)
      if (r.pair == k && r.touching && !is_rigid(r.body) && is_pressed(r, figures.max_pressure))
        figures.area += both ? 0.5 * r.weight : r.weight;
  } else {
    for (std::size_t q = 0; q < pair.num_surface_points(); ++q)
      if (pair.points.active(q)) figures.area += pair.points.weight(q);
  }
}

}  // namespace

bool is_pressed(const ContactRow& r, double largest) {
  return r.pressure_sprc > end_of_zone * largest ||
         (r.active && r.pressure_sprc > std::max(little_by_itself * r.pressure_transmitted, no_pressure * largest));
}

void mark_touching_rows(const SolvedState& state, const std::vector<int>& boundary_point,
                        std::vector<ContactRow>& rows) {
  std::vector<std::vector<char>> near;  // of the first and second body of each pair
  for (const ContactPair& pair : state.pairs)
    for (const int body : {pair.primary, pair.secondary}) near.push_back(cells_near_closed(state, pair, body));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ContactRow& row = rows[i];
    const ContactPair& pair = state.pairs[row.pair];
    const BoundaryData& boundary = state.bodies[row.body].boundary;
    const TractionCondition& condition = boundary.conditions[boundary.condition_of_point[boundary_point[i]]];
    const bool beside = !condition.traction && row.gap < row.larger_cell &&
                        near[2 * static_cast<std::size_t>(row.pair) + (row.body == pair.primary ? 0 : 1)][row.cell];
    row.touching = (row.active || beside) && !condition.holds_normal(row.x, row.normal, holds_normal);
  }
}

std::vector<PairFigures> pair_figures(const SolvedState& state, const std::vector<ContactRow>& rows) {
  std::vector<PairFigures> pairs;
  const std::vector<double> forces = forces_of_pairs(state);
  const double all_forces = forces_of_scene(state, forces);
  const std::vector<double> normal = normal_forces(state);
  std::size_t first_group = 0, first_tangent = 0;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const ContactPair& pair = state.pairs[k];
    PairFigures figures;
    figures.name = pair.spec->name;
    figures.body_first = state.scene.bodies[pair.spec->first.body].name;
    figures.body_second = state.scene.bodies[pair.spec->second.body].name;
    figures.bonded = pair.bonded();
    figures.points = static_cast<int>(pair.num_surface_points());
    for (int q = 0; q < figures.points; ++q) figures.active_points += pair.points.active(q);
    if (figures.active_points > 0 && forces[k] > rounding * all_forces) {
      add_forces(state, pair, first_group, first_tangent, forces[k], figures);
      add_zone(state, static_cast<int>(k), rows, figures);
      if (!pair.bonded() && figures.area > 0) figures.zone.normal_force = state.bodies[pair.primary].slices * normal[k];
    }
    pairs.push_back(figures);
    first_group += pair.groups.size();
    first_tangent += pair.num_tangents * pair.groups.size();
  }
  return pairs;
}

std::pair<Vec3, Vec3> friction_on_first(const SolvedState& state, std::size_t k) {
  std::size_t tangent = 0;
  for (std::size_t before = 0; before < k; ++before)
    tangent += state.pairs[before].num_tangents * state.pairs[before].groups.size();
  const ContactPair& pair = state.pairs[k];
  PairForces sums;
  for (std::size_t t = 0; t < pair.num_tangents * pair.groups.size(); ++t) sums.add_friction(state, pair, tangent + t);
  const int side = pair.spec->first.body == pair.primary ? 0 : 1;
  sum_around_axis(*state.bodies[pair.primary].spec, sums.force[side], &sums.moment[side]);
  return {sums.force[side], sums.moment[side]};
}

std::vector<double> normal_forces(const SolvedState& state) {
  std::vector<double> forces;
  std::size_t group = 0;
  for (const ContactPair& pair : state.pairs) {
    double sum = 0;
    for (std::size_t g = 0; g < pair.groups.size(); ++g) sum += state.outer.group_force[group++];
    forces.push_back(force_unit(state) * sum);
  }
  return forces;
}

std::vector<std::string> lost_force_warnings(const SolvedState& state, const std::vector<ContactRow>& rows,
                                             const std::vector<PairFigures>& pairs) {
  std::vector<std::string> warnings;
  std::size_t group = 0;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const ContactPair& pair = state.pairs[k];
    double transmitted = 0;
    for (std::size_t g = 0; g < pair.groups.size(); ++g, ++group)
      transmitted += state.outer.group_force[group] * force_unit(state);
    // On the face the pressure has the force by itself; sums over boundary points miss peaks narrower than a cell.
    if (!(pairs[k].area > 0) || pair.bonded() || pairs[k].pressure_on_face) continue;
    for (const int body : {pair.primary, pair.secondary}) {
      double recovered = 0;
      for (const ContactRow& row : rows)
        if (row.pair == static_cast<int>(k) && row.body == body && row.touching)
          recovered += row.weight * row.pressure_sprc;
      if (!(transmitted > 0) || std::abs(recovered - transmitted) <= state.scene.results.lost_force * transmitted)
        continue;
      warnings.push_back(fmt::format(
          "contact \"{}\": the pressure on \"{}\" adds up to {:.3g} N, but {:.3g} N are transmitted: the contact "
          "zone is too small for these cells, or the pressure has a peak at the rim of a face; the force is right, "
          "the pressure is not",
          pair.spec->name, state.scene.bodies[body].name, state.bodies[body].slices * recovered,
          state.bodies[body].slices * transmitted));
      break;
    }
  }
  return warnings;
}

}  // namespace cgcontact
