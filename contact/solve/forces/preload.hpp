/// Pairs that are tightened to a given force: the interference that gives it, by a secant iteration over solves
/// (Broyden's method where several pairs are tightened at once).
#pragma once

#include <string>
#include <vector>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

class Preload {
 public:
  explicit Preload(const Scene& scene);

  bool any() const { return !tightened_.empty(); }
  /// Starts from the result for the same scene on other grids.
  void start_from(const Preload& earlier);
  /// Goes on where all steps come again: with friction the forces are others then, which says nothing of the stiffness.
  void begin_again() {
    step_.setZero();
    solves_ = 1;
  }
  /// Begins before the first solve; without a start, a guess by the size of the bodies.
  void begin(const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs);
  /// Returns the amount by which a pair's interference has to exceed that of the scene, m.
  double tightening(const ContactPair& pair) const;
  /// Tightens; forces: sum of the pressure of every pair in the last solve, N. False: all preloads are reached. Else
  /// tightening() has changed, and the scene is to be solved again; throws InputError where no interference gives the
  /// force.
  bool tighten(const std::vector<ContactPair>& pairs, const std::vector<double>& forces);

 private:
  [[noreturn]] void refuse(Eigen::Index pair, double force) const;

  std::vector<const ContactSpec*> tightened_;
  Eigen::VectorXd tightening_, step_, last_force_;  ///< m, m, N; of each of them
  Eigen::VectorXd longest_;                         ///< m, side of the smaller body: no interference is larger
  Eigen::MatrixXd stiffness_;                       ///< N/m, of all together
  bool guessed_ = true;
  int solves_ = 0;
};

}  // namespace cgcontact
