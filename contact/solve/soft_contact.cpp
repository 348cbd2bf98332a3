#include "contact/solve/soft_contact.hpp"

namespace cgcontact {
namespace {

/// Of kappa: it is 1 then by default, with which a scene converges as well, in more iterations.
constexpr double softer = 0.1;
/// Parts: of a step that a line search leaves, less than which the active set swings; of the closed points that a
/// whole step changes, less than which it has come to rest.
constexpr double short_step = 0.5, few = 0.1;

}  // namespace

void SoftContact::follow(const OuterStep& step) {
  if (step.length < short_step)
    become(softer);
  else if (step.length == 1 && step.changed_points <= few * static_cast<double>(step.active_points))
    become(1);
}

void SoftContact::become(double factor) {
  for (ContactPair& pair : pairs_)
    if (!pair.bonded()) pair.modulus *= factor / factor_;
  factor_ = factor;
}

}  // namespace cgcontact
