#include "contact/adaptive/displacement_error.hpp"

#include <algorithm>
#include <cmath>

#include "contact/results/figures/displacement_estimate.hpp"
#include "contact/results/figures/probes.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// Largest fraction of a solve's error that the next one leaves: with more, convergence is not to be counted on.
constexpr double slowest = 0.75;

Vec3 at_boundary(const SolvedState& state, int body, int point) {
  const CellPoint cell_point = cell_point_of(state.bodies[body], point);
  return displacement(state, body, cell_point.cell, cell_point.xi);
}

Vec3 mean_over_face(const SolvedState& state, const FaceRef& face) {
  const BodyModel& body = state.bodies[face.body];
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const int p : BodyFace(face.face, body).points()) {
    sum += body.area(p) * at_boundary(state, face.body, p);
    area += body.area(p);
  }
  return area > 0 ? Vec3(sum / area) : sum;
}

Vec3 mean_over_points(const SolvedState& state, const ProbeSpec& probe) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Vec3& x : probe.points)
    for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
      if (probe.body >= 0 && probe.body != b) continue;
      const std::optional<CellPoint> cell_point = find_cell_point(state.bodies[b], x);
      if (!cell_point) continue;
      sum += displacement(state, b, cell_point->cell, cell_point->xi);
      ++count;
    }
  return count > 0 ? Vec3(sum / count) : sum;
}

/// Finds the largest displacement on the boundaries of all bodies, m.
double largest(const SolvedState& state) {
  double largest = 0;
  for (int b = 0; b < static_cast<int>(state.bodies.size()); ++b) {
    std::vector<double> size(state.bodies[b].cut_cells.boundary.size());
    parallel_for("cgcontact::displacement_error::largest", size.size(), grain_of_medium,
                 [&](std::size_t p) { size[p] = at_boundary(state, b, static_cast<int>(p)).norm(); });
    for (const double s : size) largest = std::max(largest, s);
  }
  return largest;
}

}  // namespace

std::vector<Vec3> named_displacements(const SolvedState& state) {
  std::vector<Vec3> values;
  for (const NamedTarget& target : state.scene.accuracy.named) {
    if (target.kind != NamedTarget::Kind::displacement) continue;
    const auto probe = std::find_if(state.scene.probes.begin(), state.scene.probes.end(),
                                    [&](const ProbeSpec& p) { return p.name == target.name; });
    const auto face = state.scene.accuracy_faces.find(target.name);
    if (face != state.scene.accuracy_faces.end())
      values.push_back(mean_over_face(state, face->second));
    else if (probe != state.scene.probes.end())
      values.push_back(probe->kind == ProbeSpec::Kind::face ? mean_over_face(state, probe->face)
                                                            : mean_over_points(state, *probe));
    else
      values.push_back(largest(state) * Vec3::UnitX());
  }
  return values;
}

std::vector<double> displacement_errors(const DisplacementState& now, const DisplacementState& before) {
  std::vector<double> errors(now.values.size(), displacement_estimate(now.energy_error));
  const bool compared = before.values.size() == now.values.size() && before.energy_error > 0;
  for (std::size_t k = 0; compared && k < errors.size(); ++k) {
    const double left = std::min(slowest, std::pow(now.energy_error / before.energy_error, 2));
    const double size = now.values[k].norm(), change = (now.values[k] - before.values[k]).norm();
    if (size > 0) errors[k] = std::max(errors[k], change / size * left / (1 - left));
  }
  for (double& error : errors) error += now.held;
  return errors;
}

}  // namespace cgcontact
