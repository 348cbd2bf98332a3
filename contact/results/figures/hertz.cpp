#include "contact/results/figures/hertz.hpp"

#include <cmath>

namespace cgcontact {
namespace {

/// Ratio of both curvatures: below it K - E is rounding, and the zone is round to 1e-8.
constexpr double round_ratio = 1 + 1e-6;

/// Complete elliptic integrals of an ellipse with the half axes 1 and `ratio` (Johnson's e is its eccentricity).
struct Integrals {
  double k, e;
  explicit Integrals(double ratio)
      : k(std::comp_ellint_1(std::sqrt(1 - ratio * ratio))), e(std::comp_ellint_2(std::sqrt(1 - ratio * ratio))) {}
};

/// Most over least curvature of the bodies whose zone has the half axes 1 and `ratio` (Johnson 4.28).
double curvature_ratio(double ratio) {
  const Integrals of(ratio);
  return (of.e / (ratio * ratio) - of.k) / (of.k - of.e);
}

}  // namespace

HertzFigures hertz_point(double force, double least, double most, double modulus) {
  const double radius = 1 / std::sqrt(least * most);
  const double size = std::cbrt(3 * force * radius / (4 * modulus));  // of a round zone
  double ratio = 1, factor = 1;                                       // b/a, Johnson's F1
  if (most > round_ratio * least) {
    double low = 1e-8, high = 1;  // the curvatures' ratio falls with b/a; by bisection of the logarithm
    for (int step = 0; step < 100; ++step) {
      ratio = std::sqrt(low * high);
      (curvature_ratio(ratio) > most / least ? low : high) = ratio;
    }
    const Integrals of(ratio);
    const double eccentricity2 = 1 - ratio * ratio;
    factor = std::cbrt(4 / (pi * eccentricity2)) * std::sqrt(ratio) *
             std::pow((of.e / (ratio * ratio) - of.k) * (of.k - of.e), 1.0 / 6);
  }
  const double mean = size * factor;  // sqrt(a b)
  return {mean / std::sqrt(ratio), mean * std::sqrt(ratio), 3 * force / (2 * pi * mean * mean)};
}

HertzFigures hertz_line(double force_per_length, double curvature, double modulus) {
  return {std::nullopt, std::sqrt(4 * force_per_length / (pi * curvature * modulus)),
          std::sqrt(force_per_length * modulus * curvature / pi)};
}

}  // namespace cgcontact
