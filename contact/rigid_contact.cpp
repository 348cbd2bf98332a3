#include "contact/rigid_contact.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Of the outer iteration's kappa E/h: with kappa = 10 the layer E/(10 h), ten cells thick.
constexpr double softer = 0.01;
/// Of the largest diagonal entry: motions that nothing resists stay where they are.
constexpr double regularisation = 1e-9;
/// Of the loads: forces that are in balance.
constexpr double balanced = 1e-6;
constexpr int most_steps = 100, most_bisections = 80;

/// gap = distance + row . motion, of the bodies first and second; second = -1: a support.
struct Spring {
  int first = 0, second = -1;
  RigidMotion row_first, row_second = RigidMotion::Zero();
  double stiffness = 0;  ///< N/m
  double distance = 0;   ///< m; of a support -value
  bool one_sided = false;

  double gap(const Eigen::VectorXd& motion) const {
    double g = distance + row_first.dot(motion.segment<6>(6 * first));
    if (second >= 0) g += row_second.dot(motion.segment<6>(6 * second));
    return g;
  }
  bool acts(double gap) const { return !one_sided || gap < 0; }
};

class RigidContact {
 public:
  RigidContact(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
               const std::vector<ContactPair>& pairs);
  /// True: the forces are in balance.
  bool solve();
  const std::vector<Spring>& springs() const { return springs_; }
  const Eigen::VectorXd& motion() const { return motion_; }

 private:
  Eigen::VectorXd force(const Eigen::VectorXd& motion) const;
  Eigen::VectorXd newton_step(const Eigen::VectorXd& force) const;
  double step_length(const Eigen::VectorXd& step) const;

  std::vector<Spring> springs_;  ///< contact groups of all pairs in order, then supports
  Eigen::VectorXd load_, motion_;
};

RigidContact::RigidContact(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                           const std::vector<ContactPair>& pairs) {
  const std::vector<RigidPiece> pieces = whole_bodies(bodies).list;
  double stiffest = 0;
  for (const ContactPair& pair : pairs) {
    stiffest = std::max(stiffest, pair.stiffness);
    for (const ContactGroup& group : pair.groups) {
      Spring spring;
      spring.first = pair.primary;
      spring.second = pair.secondary;
      spring.row_first.setZero();
      for (int q = group.first_point; q < group.last_point; ++q) {
        const ContactPoint& point = pair.points[q];
        const double share = point.weight / group.area;
        spring.row_first += share * pieces[pair.primary].row(point.x, -point.normal);
        spring.row_second += share * pieces[pair.secondary].row(point.x, point.normal);
      }
      spring.stiffness = softer * pair.stiffness * group.area;
      spring.distance = group.initial_gap;
      spring.one_sided = true;
      springs_.push_back(spring);
    }
  }
  for (const SupportPoint& p : supports) {
    Spring spring;
    spring.first = p.body;
    spring.row_first = pieces[p.body].row(global_position(bodies[p.body].cut_cells, p.cell, p.xi), p.direction);
    spring.stiffness = stiffest * p.weight;
    spring.distance = -p.value;
    springs_.push_back(spring);
  }
  load_ = loads_on(bodies, pieces).first;
  motion_ = Eigen::VectorXd::Zero(load_.size());
}

Eigen::VectorXd RigidContact::force(const Eigen::VectorXd& motion) const {
  Eigen::VectorXd sum = load_;
  for (const Spring& s : springs_) {
    const double gap = s.gap(motion);
    if (!s.acts(gap)) continue;
    sum.segment<6>(6 * s.first) -= s.stiffness * gap * s.row_first;
    if (s.second >= 0) sum.segment<6>(6 * s.second) -= s.stiffness * gap * s.row_second;
  }
  return sum;
}

Eigen::VectorXd RigidContact::newton_step(const Eigen::VectorXd& force) const {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int i, int j, const Eigen::Matrix<double, 6, 6>& block) {
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) entries.emplace_back(6 * i + r, 6 * j + c, block(r, c));
  };
  for (const Spring& s : springs_) {
    if (!s.acts(s.gap(motion_))) continue;
    add(s.first, s.first, s.stiffness * s.row_first * s.row_first.transpose());
    if (s.second < 0) continue;
    add(s.first, s.second, s.stiffness * s.row_first * s.row_second.transpose());
    add(s.second, s.first, s.stiffness * s.row_second * s.row_first.transpose());
    add(s.second, s.second, s.stiffness * s.row_second * s.row_second.transpose());
  }
  double largest = 0;  // of one spring, so that there is one if none acts
  for (const Spring& s : springs_) largest = std::max(largest, s.stiffness);
  for (int i = 0; i < load_.size(); ++i) entries.emplace_back(i, i, regularisation * largest);
  Eigen::SparseMatrix<double> matrix(load_.size(), load_.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(force);
}

/// Where along the step, up to its end, the energy is least: its slope grows.
double RigidContact::step_length(const Eigen::VectorXd& step) const {
  const auto slope = [&](double t) { return -force(motion_ + t * step).dot(step); };
  double low = 0, high = 1;
  if (slope(high) <= 0) return high;
  for (int k = 0; k < most_bisections && high - low > 1e-12 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) <= 0 ? low : high) = middle;
  }
  return high;
}

bool RigidContact::solve() {
  for (int k = 0; k < most_steps; ++k) {
    const Eigen::VectorXd now = force(motion_);
    if (now.norm() <= balanced * load_.norm()) return true;
    const Eigen::VectorXd step = newton_step(now);
    if (!step.allFinite()) return false;
    motion_ += step_length(step) * step;
  }
  return false;
}

}  // namespace

bool close_where_rigid_bodies_meet(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                   std::vector<ContactPair>& pairs) {
  RigidContact contact(bodies, supports, pairs);
  if (!contact.solve()) return false;
  auto spring = contact.springs().begin();
  for (ContactPair& pair : pairs)
    for (const ContactGroup& group : pair.groups) {
      const bool closed = (spring++)->gap(contact.motion()) < 0;
      for (int q = group.first_point; q < group.last_point; ++q) pair.points[q].active = closed;
    }
  return true;
}

}  // namespace cgcontact
