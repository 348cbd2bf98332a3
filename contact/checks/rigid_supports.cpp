#include "contact/checks/rigid_supports.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Rounding, relative to the largest prescribed displacement, also that of a scene's numbers.
constexpr double displacement_rounding = 1e-6;
/// Fraction of the firmest held motion: those that are held by less are free.
constexpr double not_held = 1e-10;

using Motion = Eigen::Matrix<double, 6, 1>;

void check(const Scene& scene, const BodyModel& body, const std::vector<const SupportPoint*>& points) {
  Vec3 centre = Vec3::Zero(), low = Vec3::Constant(1e300), high = -low;
  std::vector<Vec3> positions;
  double largest = 0;
  for (const SupportPoint* p : points) {
    positions.push_back(global_position(body.cut_cells, p->cell, p->xi));
    centre += positions.back() / static_cast<double>(points.size());
    low = low.cwiseMin(positions.back());
    high = high.cwiseMax(positions.back());
    largest = std::max(largest, std::abs(p->prescribed));
  }
  if (largest == 0) return;
  const double size = std::max((high - low).norm(), 1e-300);
  const auto row = [&](std::size_t i) {
    Motion r;
    r << points[i]->direction, ((positions[i] - centre) / size).cross(points[i]->direction);
    return r;
  };
  Eigen::Matrix<double, 6, 6> held = Eigen::Matrix<double, 6, 6>::Zero();
  Motion wanted = Motion::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    held += points[i]->weight * row(i) * row(i).transpose();
    wanted += points[i]->weight * points[i]->prescribed * row(i);
  }
  const SymmetricEigen<6> solver(held);
  Motion motion = Motion::Zero();  // the nearest one
  for (int k = 0; k < 6; ++k)
    if (const Motion v = solver.eigenvectors().col(k); solver.eigenvalues()[k] > not_held * solver.eigenvalues()[5])
      motion += v.dot(wanted) / solver.eigenvalues()[k] * v;
  std::size_t worst = 0;
  const auto misfit = [&](std::size_t i) { return std::abs(row(i).dot(motion) - points[i]->prescribed); };
  for (std::size_t i = 0; i < points.size(); ++i)
    if (misfit(i) > misfit(worst)) worst = i;
  if (misfit(worst) <= displacement_rounding * largest) return;
  const SupportSpec& support = scene.supports[points[worst]->support];
  const Vec3& x = positions[worst];
  throw InputError(
      support.location, '"' + body.spec->name + "." + support.face.face.name + '"',
      fmt::format("would deform the rigid body \"{}\": prescribes {:g} m at ({:.4g}, {:.4g}, {:.4g}) m where "
                  "the nearest rigid motion has {:g} m",
                  body.spec->name, points[worst]->prescribed, x[0], x[1], x[2], row(worst).dot(motion)),
      "displacements that are the same on all its supports, or rotation = {axis, angle}");
}

}  // namespace

void check_supports_of_rigid_bodies(const Scene& scene, const std::vector<BodyModel>& bodies,
                                    const std::vector<SupportPoint>& supports) {
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    if (!bodies[b].spec->rigid()) continue;
    std::vector<const SupportPoint*> points;
    for (const SupportPoint& p : supports)
      if (p.body == b && p.support >= 0 && !p.implied && p.spring == 0) points.push_back(&p);
    check(scene, bodies[b], points);
  }
}

}  // namespace cgcontact
