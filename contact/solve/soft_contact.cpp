#include "contact/solve/soft_contact.hpp"

#include <algorithm>

namespace cgcontact {
namespace {

/// Each time it becomes softer or stiffer; at most two times: a layer of kappa = 0.1 gives way like ten cells or more.
constexpr double step_of_kappa = 10, min_stiffness_factor = 0.01;
/// Fractions of a step that a line search leaves: after two below the first the active set swings (one is common at the
/// start), above the second it is at rest, if at most a tenth of the closed points change.
constexpr double short_step = 0.5, whole_step = 0.9, few = 0.1;

}  // namespace

SoftContact::SoftContact(std::vector<ContactPair>& pairs) : pairs_(pairs) {
  for (const ContactPair& pair : pairs) modulus_.push_back(pair.modulus);
}

void SoftContact::follow(const OuterStep& step) {
  short_steps_ = step.length < short_step ? short_steps_ + 1 : 0;
  if (short_steps_ > 1)
    become(std::max(min_stiffness_factor, factor_ / step_of_kappa));
  else if (step.length > whole_step && step.changed_points <= few * static_cast<double>(step.active_points))
    become(std::min(1.0, factor_ * step_of_kappa));
}

void SoftContact::become(double factor) {
  factor_ = factor;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (!pairs_[k].bonded()) pairs_[k].modulus = factor * modulus_[k];
}

}  // namespace cgcontact
