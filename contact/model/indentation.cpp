#include "contact/model/indentation.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

double effective_modulus(const Material& a, const Material& b) {
  const auto inverse = [](const Material& m) { return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus; };
  return 1 / (inverse(a) + inverse(b));
}

double slenderness_factor(double aspect) {
  return 0.5 * pi * std::sqrt(aspect) / std::comp_ellint_1(std::sqrt(std::max(0.0, 1 - 1 / (aspect * aspect))));
}

}  // namespace cgcontact
