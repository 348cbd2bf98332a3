#include "contact/solve/lagged_stress.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/rounding.hpp"
#include "core/base/process/shared_values.hpp"

namespace cgcontact {
namespace {

/// Square of the difference and of the new values, area-weighted.
struct Change {
  double difference = 0, norm = 0;

  void add(double weight, double before, double after) {
    difference += weight * (after - before) * (after - before);
    norm += weight * after * after;
  }

  /// New values of points, the first of which is number `first` among all.
  template <class WeightAt, class StressAt>
  void replace(PointStresses& values, std::size_t first, std::size_t count, const WeightAt& weight_at,
               const StressAt& stress_at) {
    std::vector<double> now(count);
    compute_together("cgcontact::lagged_stress::points", grain_of_medium, now, stress_at);
    for (std::size_t i = 0; i < count; ++i) {
      double& value = values.h_view(first + i);
      add(weight_at(i), value, now[i]);
      value = now[i];
    }
    values.modify_host();
  }
};

/// Motion without stress: what is recovered is rounding of E u / h, not a stress to converge to. The least square of a
/// norm that is more than that.
double square_of_rounding(const Iterate& iterate) {
  double area = 0, stiffest = 0;
  for (const SupportPoint& p : iterate.problem.supports) area += p.implied ? 0 : p.weight;
  for (const BodyMesh& mesh : iterate.problem.system.meshes)
    if (!mesh.rigid) stiffest = std::max(stiffest, mesh.modulus / mesh.h_of_level(mesh.cut_cells->grid.num_levels - 1));
  return area *
         std::pow(rounding * stiffest * iterate.body_motions.largest_displacement(iterate.problem.exec, iterate.u), 2);
}

}  // namespace

LaggedStress::LaggedStress(const OuterProblem& problem) {
  const auto cells = stabilised_cells(problem.supports, problem.pairs, problem.bodies.size());
  stress_.reserve(cells.size());
  for (std::size_t b = 0; b < cells.size(); ++b)
    stress_.emplace_back(problem.system.meshes[b], problem.scene.recovery.patch_volume, cells[b]);
}

double LaggedStress::update(Iterate& iterate) {
  const OuterProblem& problem = iterate.problem;
  for (BoundaryStress& s : stress_) s.update(iterate.u);
  const std::vector<BodyMesh>& meshes = problem.system.meshes;
  std::vector<double> held_by;
  if (std::any_of(meshes.begin(), meshes.end(), [](const BodyMesh& mesh) { return mesh.rigid; }))
    held_by = iterate.support_tractions();
  Change change;
  const std::vector<SupportPoint>& supports = problem.supports;
  const auto support_weight = [&](std::size_t s) { return supports[s].weight; };
  change.replace(iterate.support_stress, 0, supports.size(), support_weight, [&](std::size_t s) {
    const SupportPoint& p = supports[s];
    // No force in the system, or that of a spring: there is no stress to lag.
    if (p.support < 0 || p.implied || p.spring > 0) return 0.0;
    if (problem.system.meshes[p.body].rigid)  // no stress of its own: what held it in the last solution
      return held_by[s] / problem.scales.stress;
    return stress_[p.body].traction(p.cell, p.xi, p.normal, p.direction);
  });
  std::size_t first_point = 0, first_shear = 0;
  for (const ContactPair& pair : problem.pairs) {
    // The softer body's counts more, as in the stiffness: the other one's changes more with the gap, and what is lagged
    // would converge slowly.
    const double first = stabilising_modulus(problem.scene.bodies[pair.primary].material),
                 second = stabilising_modulus(problem.scene.bodies[pair.secondary].material);
    const double fraction = std::isinf(second) ? 1 : second / (first + second);  // of a rigid body nothing
    const auto weight = [&](std::size_t q) { return pair.points.weight(q); };
    const auto mean_traction = [&](const ContactPoint& c, const Vec3& direction) {
      return -fraction * stress_[pair.primary].traction(c.primary_cell, c.primary_xi, c.normal, direction) -
             (1 - fraction) * stress_[pair.secondary].traction(c.secondary_cell, c.secondary_xi, c.normal, direction);
    };
    change.replace(iterate.contact_stress, first_point, pair.points.size(), weight, [&](std::size_t q) {
      const ContactPoint c = pair.points[q];
      return mean_traction(c, c.direction);
    });
    first_point += pair.points.size();
    for (int i = 0; i < pair.num_tangents; ++i) {
      std::vector<double> shear(pair.points.size());
      compute_together("cgcontact::lagged_stress::friction", grain_of_medium, shear,
                       [&](std::size_t q) { return mean_traction(pair.points[q], pair.tangents(q)[i]); });
      for (std::size_t q = 0; q < shear.size(); ++q) iterate.friction.stress.h_view(first_shear + q, i) = shear[q];
    }
    iterate.friction.stress.modify_host();
    if (pair.num_tangents > 0) first_shear += pair.points.size();
  }
  const double norm = std::max(change.norm, square_of_rounding(iterate));
  return norm > 0 ? std::sqrt(change.difference / norm) : 0.0;
}

}  // namespace cgcontact
