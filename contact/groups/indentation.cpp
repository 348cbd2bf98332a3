#include "contact/groups/indentation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {

std::pair<double, double> axes_of_overlap(double area, const Vec3& first, const Mat3& second) {
  constexpr double slimmest = 1e-8;  // square of the ratio of the axes: less is a line, up to rounding
  const Vec3 mean = first / area;
  const SymmetricEigen<3> solver(second / area - mean * mean.transpose());
  const double largest = solver.eigenvalues()[2];
  return {4 * std::sqrt(largest), 4 * std::sqrt(std::max(solver.eigenvalues()[1], slimmest * largest))};
}

double effective_modulus(const Material& a, const Material& b) {
  const auto inverse = [](const Material& m) { return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus; };
  return 1 / (inverse(a) + inverse(b));
}

double slenderness_factor(double aspect) {
  return 0.5 * pi * std::sqrt(aspect) / std::comp_ellint_1(std::sqrt(std::max(0.0, 1 - 1 / (aspect * aspect))));
}

}  // namespace cgcontact
