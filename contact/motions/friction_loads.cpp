#include "contact/motions/friction_loads.hpp"

#include "core/base/decompositions.hpp"

namespace cgcontact {
namespace {

/// Part of what friction resists most: less is rounding, of a motion in which no such faces slide.
constexpr double no_resistance = 1e-12;

/// Calls use(pair, point, sliding, weight) for all points of pairs with friction; weight in m^2.
template <class Use>
void each_point_with_friction(const FreeMotions& motions, const std::vector<BodyModel>& bodies,
                              const std::vector<ContactPair>& pairs, const Use& use) {
  for (const ContactPair& pair : pairs) {
    if (!(pair.spec->friction > 0)) continue;
    for (const ContactPoint& point : pair.points)
      use(pair, point, sliding_at(pair, point, motions, bodies), pair.spec->friction * point.weight);
  }
}

Eigen::MatrixXd resistance_of_friction(const FreeMotions& motions, const std::vector<BodyModel>& bodies,
                                       const std::vector<ContactPair>& pairs) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(motions.modes.cols(), motions.modes.cols());
  each_point_with_friction(motions, bodies, pairs,
                           [&](const ContactPair&, const ContactPoint&, const Eigen::MatrixXd& sliding, double weight) {
                             sum += weight * sliding.transpose() * sliding;
                           });
  return sum;
}

}  // namespace

Eigen::MatrixXd sliding_at(const ContactPair& pair, const ContactPoint& point, const FreeMotions& motions,
                           const std::vector<BodyModel>& bodies) {
  Eigen::MatrixXd sliding = Eigen::MatrixXd::Zero(3, motions.modes.cols());
  const auto add = [&](int body, int cell, const Vec3& xi, double sign) {
    const Vec3 x = global_position(bodies[body].cut_cells, cell, xi);
    for (int k = 0; k < 3; ++k)
      sliding.row(k) += sign * motions.bodies[body].row(x, Vec3::Unit(k)).transpose() *
                        motions.modes.middleRows<6>(6 * static_cast<Eigen::Index>(body));
  };
  add(pair.primary, point.primary_cell, point.primary_xi, 1);
  add(pair.secondary, point.secondary_cell, point.secondary_xi, -1);
  return sliding - point.normal * (point.normal.transpose() * sliding);
}

MotionsAndFriction divide_by_friction(const FreeMotions& free, const std::vector<BodyModel>& bodies,
                                      const std::vector<ContactPair>& pairs) {
  MotionsAndFriction parts{free, free};
  parts.resisted.modes.resize(free.modes.rows(), 0);
  if (free.empty()) return parts;
  const SymmetricEigen<Eigen::Dynamic> eigen(resistance_of_friction(free, bodies, pairs));
  const Eigen::Index count = free.modes.cols();
  const double most = eigen.eigenvalues()[count - 1];
  if (!(most > 0)) return parts;
  Eigen::Index none = 0;
  while (none < count && !(eigen.eigenvalues()[none] > no_resistance * most)) ++none;
  parts.free.modes = free.modes * eigen.eigenvectors().leftCols(none);
  parts.resisted.modes = free.modes * eigen.eigenvectors().rightCols(count - none);
  return parts;
}

void put_loads_in_place_of_friction(const FreeMotions& resisted, const std::vector<ContactPair>& pairs,
                                    std::vector<BodyModel>& bodies) {
  for (BodyModel& body : bodies) body.friction_loads.clear();
  if (resisted.empty()) return;
  const auto [load, magnitude] = loads_on(bodies, resisted.bodies);
  const Eigen::VectorXd driven = resisted.modes.transpose() * load;
  if (!(driven.norm() > no_load * magnitude)) return;
  const Eigen::VectorXd share = resistance_of_friction(resisted, bodies, pairs).ldlt().solve(driven);
  each_point_with_friction(
      resisted, bodies, pairs,
      [&](const ContactPair& pair, const ContactPoint& point, const Eigen::MatrixXd& sliding, double weight) {
        const Vec3 force = weight * (sliding * share);
        bodies[pair.primary].friction_loads.push_back({point.primary_cell, point.primary_xi, -force});
        bodies[pair.secondary].friction_loads.push_back({point.secondary_cell, point.secondary_xi, force});
      });
}

Eigen::VectorXd asked_of_friction(const FreeMotions& resisted, const std::vector<BodyModel>& bodies) {
  Eigen::VectorXd work = Eigen::VectorXd::Zero(resisted.modes.rows());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (const PointForce& p : bodies[b].friction_loads)
      work.segment<6>(6 * static_cast<Eigen::Index>(b)) -=
          resisted.bodies[b].row(global_position(bodies[b].cut_cells, p.cell, p.xi), p.force);
  return resisted.modes.transpose() * work;
}

}  // namespace cgcontact
