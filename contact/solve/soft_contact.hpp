/// Softer contact for a while. With many cells across a zone kappa E/h is far stiffer than the bodies: from a wrong
/// active set each linear solve finds another wrong one, and an exact line search takes a hundredth of each step. With
/// a smaller kappa the iteration finds the zone in few steps; the pressure is in p*, so that kappa can be restored.
#pragma once

#include <vector>

#include "contact/model/contact_pairs.hpp"
#include "contact/solve/outer_loop.hpp"

namespace cgcontact {

class SoftContact {
 public:
  /// The pairs must outlive this, which leaves them as stiff as they were. Bonded ones stay as they are.
  explicit SoftContact(std::vector<ContactPair>& pairs);
  ~SoftContact() { become(1); }
  SoftContact(const SoftContact&) = delete;

  /// Adapts after an iteration: softer where a line search cut two steps short, stiffer again where one of nearly its
  /// whole length changes little.
  void follow(const OuterStep& step);
  bool is_soft() const { return factor_ < 1; }

 private:
  void become(double factor);

  std::vector<ContactPair>& pairs_;
  std::vector<double> modulus_;  // of the pairs, as it was
  int short_steps_ = 0;          // one after the other
  double factor_ = 1;            // of kappa
};

}  // namespace cgcontact
