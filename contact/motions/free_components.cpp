#include "contact/motions/free_components.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "contact/motions/free_motion.hpp"
#include "contact/motions/rigid_motion.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Fraction of a motion that is rounding.
constexpr double negligible = 1e-3;
/// Mean squared resistance of a face to a motion (of 1 at its fastest) that makes it worth naming.
constexpr double worth_holding = 0.02;
constexpr std::size_t max_components = 1000;

/// Formats a vector; components that are rounding beside the others, or beside `size`, are zero.
std::string as_text(const Vec3& v, double size = 0) {
  const Vec3 x = without_rounding(v, std::max(size, v.norm()));
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]);
}

std::string motion_text(const RigidComponent& component, const RigidMotion& m) {
  const Vec3 t = m.head<3>(), r = m.tail<3>() / component.size();
  if (m.tail<3>().norm() < negligible * m.norm()) return "move along " + direction_text(t.normalized());
  const Vec3 axis = r.normalized();
  // A screw: its axis passes where the velocity is along it.
  const Vec3 point = component.centre() + r.cross(t) / r.squaredNorm();
  const bool slides = std::abs(t.dot(axis)) > negligible * m.norm();
  return fmt::format("{} about the axis along {} through {}", slides ? "turn and move" : "rotate", direction_text(axis),
                     as_text(point, component.size()));
}

/// Orthonormal basis of the motions of `free` (columns) that `gram` does not resist.
Eigen::MatrixXd not_resisted(const Eigen::MatrixXd& free, const Eigen::MatrixXd& gram) {
  const SymmetricEigen<Eigen::Dynamic> eigen(free.transpose() * gram * free);
  Eigen::Index left = 0;
  while (left < free.cols() && eigen.eigenvalues()[left] < worth_holding) ++left;
  return free * eigen.eigenvectors().leftCols(left);
}

/// Motions along and about x, y, z first, as far as they are free; then what is left. Columns of `free` are
/// orthonormal.
std::vector<RigidMotion> readable_motions(Eigen::MatrixXd free) {
  std::vector<RigidMotion> motions;
  const auto take = [&](const RigidMotion& m) {
    motions.push_back(m);
    const Eigen::MatrixXd rest = free - m * (m.transpose() * free);
    const SingularValues svd(rest, Eigen::ComputeThinU);
    free = svd.left().leftCols(free.cols() - 1);
  };
  for (int k = 0; k < 6 && free.cols() > 0; ++k) {
    const RigidMotion m = RigidMotion::Unit(k);
    if ((m - free * (free.transpose() * m)).norm() < negligible) take(m);
  }
  while (free.cols() > 0) take(free.col(0));
  return motions;
}

class FreeMotion {
 public:
  FreeMotion(const Scene& scene, const std::vector<BodyModel>& bodies)
      : scene_(scene), bodies_(bodies), components_(components_of(bodies)) {}

  std::string describe(const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) const {
    if (components_.list.size() > max_components)
      return fmt::format("the bodies are in {} separate pieces: are the cells larger than their walls?",
                         components_.list.size());
    const Eigen::MatrixXd modes = free_rigid_motions(components_, bodies_, supports, pairs);
    return modes.cols() == 0 ? "" : describe(modes);
  }

 private:
  std::string describe(const Eigen::MatrixXd& modes) const {
    Eigen::Index chosen = 0;  // the component that moves most
    double most = -1;
    for (std::size_t k = 0; k < components_.list.size(); ++k) {
      const double share = modes.middleRows<6>(static_cast<Eigen::Index>(6 * k)).norm();
      if (share > most * (1 + negligible)) chosen = static_cast<Eigen::Index>(k);
      most = std::max(most, share);
    }
    const RigidComponent& component = components_.list[chosen];
    const Eigen::MatrixXd own = modes.middleRows<6>(6 * chosen);
    const SingularValues svd(own, Eigen::ComputeThinU | Eigen::ComputeThinV);
    Eigen::Index dimension = 0;
    while (dimension < svd.values().size() && svd.values()[dimension] > negligible) ++dimension;
    const Eigen::MatrixXd free = svd.left().leftCols(dimension);
    if (dimension == 6)
      return fmt::format(
          "{} is not held at all: it is free to move and rotate in every direction: add supports or "
          "contacts that hold it{}",
          component_text(chosen), advice(chosen, free));
    std::string text;
    const std::vector<RigidMotion> motions = readable_motions(free);
    for (std::size_t k = 0; k < motions.size(); ++k)
      text += (k == 0 ? "" : k + 1 < motions.size() ? ", to " : " and to ") + motion_text(component, motions[k]);
    // The motion of all in which this component does the first one and the others as little as they can.
    const Eigen::VectorXd share = (free.transpose() * motions[0]).cwiseQuotient(svd.values().head(dimension));
    const Eigen::VectorXd together = modes * (svd.right().leftCols(dimension) * share);
    return fmt::format("{} is free to {}{}: add a support or a contact that holds it{}", component_text(chosen), text,
                       companions_text(chosen, together), advice(chosen, free));
  }

  std::string component_text(Eigen::Index k) const {
    const RigidComponent& component = components_.list[k];
    const std::string name = fmt::format("body \"{}\"", scene_.bodies[component.body].name);
    const auto same = [&](const RigidComponent& other) { return other.body == component.body; };
    const auto count = std::count_if(components_.list.begin(), components_.list.end(), same);
    if (count == 1) return name;
    const auto number = std::count_if(components_.list.begin(), components_.list.begin() + k + 1, same);
    return fmt::format("{} is in {} separate pieces: piece {}, from {} to {} m,", name, count, number,
                       as_text(component.low), as_text(component.high));
  }

  std::string companions_text(Eigen::Index chosen, const Eigen::VectorXd& motion) const {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < components_.list.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(k);
      const std::string name = '"' + scene_.bodies[components_.list[k].body].name + '"';
      if (index != chosen && motion.segment<6>(6 * index).norm() > negligible * motion.norm() &&
          std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
    }
    return names.empty() ? "" : fmt::format(" (together with {})", fmt::join(names, ", "));
  }

  /// Supports that would hold the motions, chosen one by one: faces held along their normal if that resists, else in a
  /// global direction.
  std::string advice(Eigen::Index chosen, Eigen::MatrixXd free) const {
    std::map<std::string, Eigen::Matrix<double, 6, 6>> resistance;  // of "face", symmetry ... per unit area
    std::map<std::string, double> area;
    const RigidComponent& component = components_.list[chosen];
    const BodyModel& body = bodies_[component.body];
    for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
      if (components_.of_cell[component.body][body.cut_cells.boundary.cell[p]] != chosen) continue;
      if (body.boundary.pair_of_point[p] >= 0) continue;
      for (const std::string& name : body.surface_names(p)) {
        const std::string face = fmt::format("{{face = \"{}.{}\", ", scene_.bodies[component.body].name, name);
        const auto add = [&](const std::string& how, const Vec3& d) {
          const RigidMotion q = component.row(body.point(p), d);
          const auto entry = resistance.emplace(face + how, Eigen::Matrix<double, 6, 6>::Zero()).first;
          entry->second.noalias() += body.area(p) * q * q.transpose();
          area[face + how] += body.area(p);
        };
        add("symmetry = true}", body.normal(p));
        for (int k = 0; k < 3; ++k) add(fmt::format("displacement = {{{} = 0}}}}", "xyz"[k]), Vec3::Unit(k));
      }
    }
    std::string text;
    while (free.cols() > 0) {
      std::string best;
      double most = worth_holding;
      for (const bool by_symmetry : {true, false})
        for (const auto& [how, sum] : resistance) {
          if ((how.find("symmetry") != std::string::npos) != by_symmetry || (!by_symmetry && !best.empty())) continue;
          const Eigen::MatrixXd gram = free.transpose() * sum * free / area[how];
          const double held = SymmetricEigen<Eigen::Dynamic>(gram).eigenvalues().maxCoeff();
          if (held > most * (1 + negligible)) best = how;
          most = std::max(most, held);
        }
      if (best.empty()) break;
      text += (text.empty() ? ", for example [[support]] " : " and ") + best;
      free = not_resisted(free, resistance[best] / area[best]);
    }
    return text;
  }

  const Scene& scene_;
  const std::vector<BodyModel>& bodies_;
  const RigidComponents components_;
};

}  // namespace

std::string find_free_motion(const Scene& scene, const std::vector<BodyModel>& bodies,
                             const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) {
  return FreeMotion(scene, bodies).describe(supports, pairs);
}

}  // namespace cgcontact
