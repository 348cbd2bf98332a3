/// Rigid bodies between springs under loads: where they come to rest.
#pragma once

#include <utility>
#include <vector>

#include "contact/motions/rigid_motion.hpp"
#include "contact/solve/forces/friction.hpp"

namespace cgcontact {

/// Change of a gap or a slip with the rigid motions of two bodies.
struct RowOnMotions {
  RigidMotion first = RigidMotion::Zero(), second = RigidMotion::Zero();

  /// Returns the row on the motions that the bodies' projections leave.
  template <class Projections>
  RowOnMotions on(const Projections& free, int first_body, int second_body) const {
    return {free[first_body] * first, free[second_body] * second};
  }
  /// Returns the row on the motions of all bodies, `size` of them; second_body = -1: none.
  Eigen::VectorXd of_all(int first_body, int second_body, Eigen::Index size) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(size);
    all.segment<6>(6 * first_body) = first;
    if (second_body >= 0) all.segment<6>(6 * second_body) = second;
    return all;
  }
};

/// Spring that presses at points by its law, gap = distance + row . motion. second = -1: a support, which also pulls.
struct Spring {
  int first = 0, second = -1;
  NormalContact law;
  RowOnMotions row;
  double distance = 0;  ///< m
  int first_point = 0, last_point = 0;

  double change(const Eigen::VectorXd& motion) const {
    double sum = row.first.dot(motion.segment<6>(6 * first));
    if (second >= 0) sum += row.second.dot(motion.segment<6>(6 * second));
    return sum;
  }
};

struct SpringPoint {
  double weight = 0, stress = 0;  ///< m^2, Pa
};

/// Friction of a group whose slip follows the motions of two bodies. The law must outlive it.
struct Rubbing {
  int first = 0, second = 0;
  RowOnMotions along[2];  ///< of each tangent; zero for one that the group does not have
  const FrictionGroup* law = nullptr;
  bool by_law = true;  ///< or by its linear force

  Eigen::Vector2d change(const Eigen::VectorXd& motion) const;
  /// Returns the force by tangents at a slip (m), N, and its fall with that, N/m.
  std::pair<Eigen::Vector2d, Eigen::Matrix2d> force(const Eigen::Vector2d& slip) const;
};

/// Rigid bodies between springs, under loads: convex and, but for what slips in two directions, piecewise quadratic.
struct BodiesOnSprings {
  std::vector<Spring> springs;
  std::vector<SpringPoint> points;
  std::vector<Rubbing> rubbing;
  Eigen::VectorXd load, motion;  ///< (6 bodies)

  explicit BodiesOnSprings(const Eigen::VectorXd& loads) : load(loads), motion(Eigen::VectorXd::Zero(loads.size())) {}
  /// Adds a spring of one point, without stress. area: m^2.
  void add(Spring spring, double area);
  /// Returns the force of one spring, N, and the area that presses, m^2.
  std::pair<double, double> press(const Spring& s, double gap) const;
  double gap(const Spring& s) const { return s.distance + s.change(motion); }
  Eigen::Vector2d slip(const Rubbing& r) const;
  /// Moves the bodies to the minimum of the energy. True: the forces are in balance.
  bool solve();
  /// Returns whether the springs that press resist all motions of the bodies, each on a projection of these.
  bool holds(const std::vector<Eigen::Matrix<double, 6, 6>>& free) const;
  /// Returns the sum of all forces on the bodies.
  Eigen::VectorXd unbalanced() const;
  /// Returns the sum of the magnitudes of loads and forces.
  double scale() const;

 private:
  Eigen::VectorXd newton_step(const Eigen::VectorXd& force, double open) const;
  double step_length(const Eigen::VectorXd& step) const;
};

}  // namespace cgcontact
