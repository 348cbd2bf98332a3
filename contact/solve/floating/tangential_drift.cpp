#include "contact/solve/floating/tangential_drift.hpp"

#include <algorithm>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Fraction of the loads that may be left along a motion that they do not drive.
constexpr double hardly_driven = 1e-3;

/// Orthonormal columns that span the rows of some bodies (the others' are zero) in `modes`.
Eigen::MatrixXd of_bodies(const Eigen::MatrixXd& modes, const std::vector<int>& members) {
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(modes.rows(), modes.cols());
  for (const int b : members) own.middleRows<6>(6 * b) = modes.middleRows<6>(6 * b);
  if (own.cols() == 0) return own;
  const SingularValues svd(own, Eigen::ComputeThinU);
  return svd.left().leftCols((svd.values().array() > 1e-3).count());
}

/// Without the one that the loads do work on.
Eigen::MatrixXd not_driven(const Eigen::MatrixXd& modes, const Eigen::VectorXd& load, double magnitude) {
  const Eigen::VectorXd work = modes.transpose() * load;
  if (work.norm() <= hardly_driven * magnitude) return modes;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(work);
  const Eigen::MatrixXd q = qr.householderQ();
  return modes * q.rightCols(modes.cols() - 1);
}

/// The smallest cell where one of the bodies may touch others, m; 0 without contact.
double smallest_contact_cell(const std::vector<ContactPair>& pairs, const std::vector<int>& members) {
  double smallest = 1e300;
  const auto is_member = [&](int body) { return std::count(members.begin(), members.end(), body) > 0; };
  for (const ContactPair& pair : pairs)
    if (is_member(pair.primary) != is_member(pair.secondary))
      for (const ContactGroup& group : pair.groups) smallest = std::min(smallest, group.h);
  return smallest < 1e300 ? smallest : 0;
}

}  // namespace

TangentialDrift::TangentialDrift(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                 const std::vector<ContactPair>& pairs) {
  std::vector<SupportPoint> still;
  for (const SupportPoint& p : supports)
    if (!p.follows) still.push_back(p);
  SurfaceMotions along = find_surface_motions(bodies, still, pairs);
  FreeMotions all = along.own;
  all.add(along.others);
  const auto [load, magnitude] = loads_on(bodies, all.bodies);
  const std::vector<int> assembly = bonded_assemblies(bodies.size(), pairs);
  for (int first = 0; first < static_cast<int>(bodies.size()); ++first) {
    if (assembly[first] != first) continue;
    std::vector<int> members;
    for (int b = first; b < static_cast<int>(bodies.size()); ++b)
      if (assembly[b] == first) members.push_back(b);
    DriftingBody drifting{all, smallest_contact_cell(pairs, members)};
    drifting.motions.modes = not_driven(of_bodies(all.modes, members), load, magnitude);
    if (!drifting.motions.empty() && drifting.cell > 0) bodies_.push_back(drifting);
  }
}

double TangentialDrift::farthest(const std::vector<BodyMotion>& motions) const {
  double most = 0;
  for (const DriftingBody& drifting : bodies_) {
    Eigen::VectorXd motion(6 * motions.size());
    for (std::size_t b = 0; b < motions.size(); ++b) {
      const RigidComponent& component = drifting.motions.bodies[b];
      motion.segment<3>(6 * b) =
          motions[b].translation + motions[b].rotation.cross(component.centre() - motions[b].centre);
      motion.segment<3>(6 * b + 3) = component.size() * motions[b].rotation;
    }
    most = std::max(most, (drifting.motions.modes.transpose() * motion).norm() / drifting.cell);
  }
  return most;
}

std::vector<SupportPoint> TangentialDrift::hold(const std::vector<BodyModel>& bodies) const {
  std::vector<SupportPoint> points;
  for (const DriftingBody& drifting : bodies_)
    for (const SupportPoint& point : cgcontact::hold(drifting.motions, bodies)) {
      points.push_back(point);
      points.back().holds_along_surface = true;
    }
  return points;
}

}  // namespace cgcontact
