#include "contact/solve/floating/bodies_on_springs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace cgcontact {
namespace {

/// Fraction of the largest diagonal entry that is added: motions that nothing resists stay where they are.
constexpr double regularisation = 1e-9;
/// Fraction of their stiffness that open springs have in the first steps, so that a body which nothing presses yet is
/// not sent off to where the first one stops it, and its factor per whole step.
constexpr double open_at_first = 0.1, open_falls = 0.1;
/// Fractions of the loads and contact forces: forces in balance, and the aim where rounding allows.
constexpr double balanced = 1e-6, well_balanced = 1e-11;
/// Fraction of the largest resistance to rigid motions below which nothing holds them.
constexpr double no_hold = 1e-3;
/// Steps; beyond `many_steps` what is balanced is good enough.
constexpr int max_steps = 100, many_steps = 30, max_halvings = 80;

}  // namespace

Eigen::Vector2d Rubbing::change(const Eigen::VectorXd& motion) const {
  const RigidMotion of_first = motion.segment<6>(6 * first), of_second = motion.segment<6>(6 * second);
  return {along[0].first.dot(of_first) + along[0].second.dot(of_second),
          along[1].first.dot(of_first) + along[1].second.dot(of_second)};
}

std::pair<Eigen::Vector2d, Eigen::Matrix2d> Rubbing::force(const Eigen::Vector2d& slip) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d fall = Eigen::Matrix2d::Zero();
  if (!by_law) {
    fall << law->fall[0], law->fall[1], law->fall[1], law->fall[2];
    sum = Eigen::Vector2d(law->force[0], law->force[1]) - fall * (slip - Eigen::Vector2d(law->slip[0], law->slip[1]));
    return {sum, fall};
  }
  for (const FrictionGroup::Point& q : law->points) {
    const TangentialContact at(law->k, q.lagged, slip.data(), q.held);
    sum += q.weight * at.carried_fraction(q.bound) * Eigen::Vector2d(at.z[0], at.z[1]);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) fall(i, j) += q.weight * at.stiffness(q.bound, held_in_slip, i, j);
  }
  return {sum, fall};
}

void BodiesOnSprings::add(Spring spring, double area) {
  spring.first_point = static_cast<int>(points.size());
  points.push_back({area, 0});
  spring.last_point = static_cast<int>(points.size());
  springs.push_back(spring);
}

std::pair<double, double> BodiesOnSprings::press(const Spring& s, double gap) const {
  double force = 0, area = 0;
  for (int q = s.first_point; q < s.last_point; ++q) {
    const double p = s.law.closed_pressure(points[q].stress, gap);
    if (!s.law.is_closed(p)) continue;
    force += points[q].weight * p;
    area += points[q].weight;
  }
  return {force, area};
}

Eigen::Vector2d BodiesOnSprings::slip(const Rubbing& r) const {
  return Eigen::Vector2d(r.law->slip[0], r.law->slip[1]) + r.change(motion);
}

Eigen::VectorXd BodiesOnSprings::unbalanced() const {
  Eigen::VectorXd sum = load;
  for (const Spring& s : springs) {
    const double force = press(s, gap(s)).first;
    if (force == 0) continue;
    sum.segment<6>(6 * s.first) += force * s.row.first;
    if (s.second >= 0) sum.segment<6>(6 * s.second) += force * s.row.second;
  }
  for (const Rubbing& r : rubbing) {
    const Eigen::Vector2d force = r.force(slip(r)).first;
    for (int i = 0; i < 2; ++i) {
      sum.segment<6>(6 * r.first) += force[i] * r.along[i].first;
      sum.segment<6>(6 * r.second) += force[i] * r.along[i].second;
    }
  }
  return sum;
}

double BodiesOnSprings::scale() const {
  double sum = load.norm();
  for (const Spring& s : springs) sum += std::abs(press(s, gap(s)).first);
  for (const Rubbing& r : rubbing) sum += r.force(slip(r)).first.norm();
  return sum;
}

/// Returns a Newton step; open: fraction of their stiffness that open springs have.
Eigen::VectorXd BodiesOnSprings::newton_step(const Eigen::VectorXd& force, double open) const {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Eigen::Matrix<double, 6, 6>> diagonal(load.size() / 6, Eigen::Matrix<double, 6, 6>::Zero());
  const auto add = [&](int i, int j, const Eigen::Matrix<double, 6, 6>& block) {
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) entries.emplace_back(6 * i + r, 6 * j + c, block(r, c));
  };
  double largest = 0;  // of one spring, so that there is one if none acts
  for (const Spring& s : springs) {
    double all = 0;
    for (int q = s.first_point; q < s.last_point; ++q) all += points[q].weight;
    largest = std::max(largest, s.law.k * all);
    const double pressing = press(s, gap(s)).second;
    const double k = s.law.k * (pressing + open * (all - pressing));
    if (k == 0) continue;
    diagonal[s.first] += k * s.row.first * s.row.first.transpose();
    if (s.second < 0) continue;
    diagonal[s.second] += k * s.row.second * s.row.second.transpose();
    const Eigen::Matrix<double, 6, 6> between = k * s.row.first * s.row.second.transpose();
    add(s.first, s.second, between);
    add(s.second, s.first, between.transpose());
  }
  for (const Rubbing& r : rubbing) {
    const Eigen::Matrix2d k = r.force(slip(r)).second;
    Eigen::Matrix<double, 6, 2> a, b;
    a << r.along[0].first, r.along[1].first;
    b << r.along[0].second, r.along[1].second;
    diagonal[r.first] += a * k * a.transpose();
    diagonal[r.second] += b * k * b.transpose();
    add(r.first, r.second, a * k * b.transpose());
    add(r.second, r.first, b * k * a.transpose());
  }
  for (std::size_t b = 0; b < diagonal.size(); ++b) {
    diagonal[b].diagonal().array() += regularisation * largest;
    add(static_cast<int>(b), static_cast<int>(b), diagonal[b]);
  }
  Eigen::SparseMatrix<double> matrix(load.size(), load.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(force);
}

/// Returns the position of least energy along the step, up to its end: the slope of the energy grows.
double BodiesOnSprings::step_length(const Eigen::VectorXd& step) const {
  std::vector<std::pair<double, double>> gaps;  // now, and its change along the step
  gaps.reserve(springs.size());
  for (const Spring& s : springs) gaps.emplace_back(gap(s), s.change(step));
  const double work = load.dot(step);
  const auto slope = [&](double t) {
    double sum = -work;
    for (std::size_t k = 0; k < springs.size(); ++k)
      if (gaps[k].second != 0) sum -= press(springs[k], gaps[k].first + t * gaps[k].second).first * gaps[k].second;
    for (const Rubbing& r : rubbing) {
      const Eigen::Vector2d change = r.change(step);
      sum -= r.force(slip(r) + t * change).first.dot(change);
    }
    return sum;
  };
  double low = 0, high = 1;
  if (slope(high) <= 0) return high;
  for (int k = 0; k < max_halvings && high - low > 1e-12 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) <= 0 ? low : high) = middle;
  }
  return high;
}

bool BodiesOnSprings::solve() {
  double open = open_at_first;
  for (int k = 0; k < max_steps; ++k) {
    const Eigen::VectorXd now = unbalanced();
    if (now.norm() <= (k < many_steps ? well_balanced : balanced) * scale()) return true;
    const Eigen::VectorXd step = newton_step(now, open);
    if (!step.allFinite()) return false;
    const double length = step_length(step);
    motion += length * step;
    if (length == 1) open = std::max(open_falls * open, regularisation);
  }
  return unbalanced().norm() <= balanced * scale();
}

bool BodiesOnSprings::holds(const std::vector<Eigen::Matrix<double, 6, 6>>& free) const {
  Eigen::MatrixXd resistance = Eigen::MatrixXd::Zero(load.size(), load.size());
  for (const Spring& s : springs) {
    const Eigen::VectorXd row = s.row.of_all(s.first, s.second, load.size());
    resistance += s.law.k * press(s, gap(s)).second * row * row.transpose();
  }
  const double largest = resistance.diagonal().maxCoeff();
  for (std::size_t b = 0; b < free.size(); ++b)
    resistance.block<6, 6>(6 * b, 6 * b) += largest * (Eigen::Matrix<double, 6, 6>::Identity() - free[b]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(resistance, Eigen::EigenvaluesOnly);
  return largest > 0 && eigen.eigenvalues()[0] > no_hold * largest;
}

}  // namespace cgcontact
