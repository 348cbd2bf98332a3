#include "contact/results/verdict/open_gaps.hpp"

#include <algorithm>
#include <cmath>

#include "contact/groups/indentation.hpp"
#include "contact/results/verdict/missed_contact.hpp"
#include "contact/results/verdict/verdict.hpp"
#include "contact/solve/iterate.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Safety factor of the error of the displacements. The change of the gap with cells 2.5 times smaller, over eta^2
/// times the deformation: 0.3 in the median of 50 random scenes, 1.7 and 3.4 at the upper quarter and tenth, 5.8 at
/// most (docs/decisions.md).
constexpr double safety = 3;
/// Fraction of the error that a gap counts as, where it is next to nothing.
constexpr double min_gap_ratio = 0.1;

/// The largest displacement by which each body deforms, its rigid motion aside, m.
std::vector<double> deformations(const SolvedState& state) {
  const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), state.outer.u);
  std::vector<double> largest;
  for (const BodyMesh& mesh : state.system.meshes) {
    double here = 0;
    for (int n = mesh.first_node; n < mesh.first_node + mesh.num_nodes; ++n)
      here = std::max(here, Vec3(u(dof_offset(n)), u(dof_offset(n) + 1), u(dof_offset(n) + 2)).norm());
    const BodyMotion& motion = state.outer.body_motions[largest.size()];
    const BodyModel& body = state.bodies[largest.size()];
    const double moved =
        motion.translation.norm() + (motion.rotation.norm() + motion.expansion.norm()) * longest_extent(body);
    here *= state.scales.length;
    largest.push_back(mesh.rigid || here < rounding * moved ? 0 : here);
  }
  return largest;
}

/// Square of the relative error of the energy norm of one body; at most 1.
double squared_error(const BodyFields& body) {
  double error = 0, energy = 0;
  for (const double e : body.error_of_cell) error += e * e;
  for (const double e : body.energy_of_cell) energy += e;
  return energy > 0 ? std::min(error / energy, 1.0) : 0;
}

/// Returns the deepest overlap of a pair that presses elsewhere, unless all of them would transmit less than min_force,
/// N.
std::optional<LeastGap> deepest_overlap(const SolvedState& state, std::size_t pair, double min_force) {
  double force = 0;
  std::optional<LeastGap> deepest;
  for (const HiddenOverlap& overlap : hidden_overlaps(state, pair)) {
    force += overlap.force;
    if (!deepest || overlap.deepest.gap < deepest->gap) deepest = overlap.deepest;
  }
  return force < min_force ? std::nullopt : deepest;
}

}  // namespace

void estimate_gap_errors(const SolvedState& state, const std::vector<ContactRow>& rows,
                         const std::vector<BodyFields>& bodies, std::vector<PairFigures>& pairs) {
  const double largest = largest_pressing_force(pairs);
  std::vector<double> deformation;
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const ContactPair& pair = state.pairs[p];
    PairFigures& figures = pairs[p];
    if (pair.bonded()) continue;
    const auto nearest = figures.active_points > 0 ? deepest_overlap(state, p, relevant_force_fraction * largest)
                                                   : min_gap(state, rows, p);
    if (!nearest) continue;
    figures.min_gap = nearest->gap;
    figures.min_gap_at = nearest->x;
    figures.min_gap_cell = nearest->cell;
    figures.min_gap_error = 0;
    if (figures.active_points > 0) continue;  // an overlap is one whatever the error
    if (deformation.empty()) deformation = deformations(state);
    for (const int body : {pair.primary, pair.secondary})
      *figures.min_gap_error += safety * squared_error(bodies[body]) * deformation[body];
  }
}

double refinement_to_tell(double gap, double error) { return std::sqrt(std::max(gap / error, min_gap_ratio)); }

std::vector<UnclearGap> unclear_gaps(const SolvedState& state, const std::vector<PairFigures>& pairs) {
  std::vector<UnclearGap> unclear;
  for (std::size_t p = 0; p < state.pairs.size(); ++p) {
    const PairFigures& figures = pairs[p];
    if (!figures.min_gap || !(*figures.min_gap <= *figures.min_gap_error) || *figures.min_gap_error == 0) continue;
    const ContactPair& pair = state.pairs[p];
    const double modulus =
        effective_modulus(state.scene.bodies[pair.primary].material, state.scene.bodies[pair.secondary].material);
    unclear.push_back({static_cast<int>(p), *figures.min_gap, *figures.min_gap_error, figures.min_gap_at,
                       figures.min_gap_cell,
                       indentation * modulus * figures.min_gap_cell * (*figures.min_gap_error - *figures.min_gap)});
  }
  return unclear;
}

}  // namespace cgcontact
