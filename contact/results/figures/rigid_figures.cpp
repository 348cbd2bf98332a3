#include "contact/results/figures/rigid_figures.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// In plane strain there are moments about the axis only: the ends hold the body against others. Around an axis of
/// revolution they cancel out.
Vec3 about_axes(const BodyModel& body, const Vec3& moment) {
  if (body.spec->axisymmetric()) return Vec3::Zero();
  const Vec3 whole = body.slices * moment;
  if (!body.spec->plane_strain) return whole;
  const int axis = static_cast<int>(*body.spec->plane_strain);
  return whole[axis] * Vec3::Unit(axis);
}

/// Sets components that are rounding to 0; of a rotation by what it moves the farthest points.
void leave_out_rounding(double size, RigidFigures& figures) {
  const double largest = std::max(figures.displacement.norm(), size * figures.rotation.norm());
  figures.displacement = without_rounding(figures.displacement, largest);
  figures.rotation = without_rounding(figures.rotation, largest / size);
}

RigidFigures figures_of(const SolvedState& state, int b, const std::vector<PairFigures>& pairs) {
  const BodyModel& body = state.bodies[b];
  RigidFigures figures;
  const double size = body.slices * volume(body.cut_cells) * std::pow(body.cut_cells.grid.cell_size, 3);
  const Vec3 c = resultants_of_volume(
                     body, [](const Vec3& x) { return x; }, Vec3::Zero())
                     .first /
                 size;
  figures.centre = c;
  figures.displacement = state.outer.body_motions[b].at(c);
  figures.rotation = state.outer.body_motions[b].rotation;
  leave_out_rounding(longest_extent(body), figures);
  Vec3 loads = Vec3::Zero(), supports = Vec3::Zero(), contact = Vec3::Zero();
  each_force(body, [&](int, const Vec3&, const Vec3& x, const Vec3& force) { loads += (x - c).cross(force); });
  for (std::size_t s = 0; s < state.supports.size(); ++s) {
    const SupportPoint& p = state.supports[s];
    if (p.body != b || p.support < 0 || p.implied) continue;
    const Vec3 force = p.weight * state.outer.support_stress[s] * p.direction;
    supports += (global_position(body.cut_cells, p.cell, p.xi) - c).cross(force);
  }
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const PairFigures& pair = pairs[k];
    if (state.pairs[k].spec->first.body == b) contact += pair.moment_on_first - c.cross(pair.force_on_first);
    if (state.pairs[k].spec->second.body == b) contact += pair.moment_on_second - c.cross(pair.force_on_second);
  }
  figures.loads = about_axes(body, loads);
  figures.supports = about_axes(body, supports);
  figures.contact = about_axes(body, contact);
  return figures;
}

}  // namespace

void set_rigid_figures(const SolvedState& state, const std::vector<PairFigures>& pairs,
                       std::vector<BodyFields>& bodies) {
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b)
    if (state.bodies[b].spec->rigid()) bodies[b].rigid = figures_of(state, b, pairs);
}

}  // namespace cgcontact
