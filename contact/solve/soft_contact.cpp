#include "contact/solve/soft_contact.hpp"

#include <algorithm>

namespace cgcontact {
namespace {

/// Each time it becomes softer or stiffer; at most two times: a layer of kappa = 0.1 gives way like ten cells or more.
constexpr double step_of_kappa = 10, softest = 0.01;
/// Parts: of a step that a line search leaves, less than which the active set swings; of the closed points that a
/// whole step changes, less than which it has come to rest.
constexpr double short_step = 0.5, few = 0.1;

}  // namespace

SoftContact::SoftContact(std::vector<ContactPair>& pairs) : pairs_(pairs) {
  for (const ContactPair& pair : pairs) modulus_.push_back(pair.modulus);
}

void SoftContact::follow(const OuterStep& step) {
  if (step.length < short_step)
    become(std::max(softest, factor_ / step_of_kappa));
  else if (step.length == 1 && step.changed_points <= few * static_cast<double>(step.active_points))
    become(std::min(1.0, factor_ * step_of_kappa));
}

void SoftContact::become(double factor) {
  factor_ = factor;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (!pairs_[k].bonded()) pairs_[k].modulus = factor * modulus_[k];
}

}  // namespace cgcontact
