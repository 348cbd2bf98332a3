/// Polynomial displacements with their stresses and body forces, for tests.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "kernels/mesh/hex.hpp"

namespace cgcontact::test {

/// A polynomial displacement up to degree 3 (m, global axes), its stress and the body force that holds it.
class Displacement {
 public:
  Displacement(double youngs_modulus, double poisson_ratio) : E_(youngs_modulus), law_(poisson_ratio) {}

  /// All terms up to a degree, by chance.
  static Displacement random(int degree, double youngs_modulus, double poisson_ratio) {
    Displacement u(youngs_modulus, poisson_ratio);
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a <= degree; ++a)
        for (int b = 0; a + b <= degree; ++b)
          for (int c = 0; a + b + c <= degree; ++c) u.terms_[i].push_back({uniform(generator), {a, b, c}});
    return u;
  }
  /// The gradient of a harmonic polynomial of degree 4: no body force.
  static Displacement harmonic(double youngs_modulus, double poisson_ratio) {
    const std::vector<Term> potential{{1, {4, 0, 0}},    {-6, {2, 2, 0}},  {1, {0, 4, 0}},    {0.7, {3, 0, 1}},
                                      {-2.1, {1, 2, 1}}, {0.4, {0, 3, 1}}, {-0.4, {0, 1, 3}}, {0.9, {3, 0, 0}},
                                      {-2.7, {1, 0, 2}}, {0.5, {1, 1, 1}}, {0.3, {2, 0, 0}},  {-0.3, {0, 0, 2}}};
    Displacement u(youngs_modulus, poisson_ratio);
    for (const Term& term : potential)
      for (int i = 0; i < 3; ++i) {
        Term derivative = term;
        derivative.factor *= derivative.exponent[i]--;
        if (derivative.factor != 0) u.terms_[i].push_back(derivative);
      }
    return u;
  }

  Vec3 value(const Vec3& x) const { return {derivative(0, {}, x), derivative(1, {}, x), derivative(2, {}, x)}; }
  Mat3 stress(const Vec3& x) const {
    Mat3 gradient;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) gradient(i, j) = derivative(i, {j}, x);
    return E_ * (law_.lambda * gradient.trace() * Mat3::Identity() + law_.mu * (gradient + gradient.transpose()));
  }
  Vec3 body_force(const Vec3& x) const {
    Vec3 force;
    for (int i = 0; i < 3; ++i) {
      force[i] = 0;
      for (int j = 0; j < 3; ++j)
        force[i] -= E_ * ((law_.lambda + law_.mu) * derivative(j, {i, j}, x) + law_.mu * derivative(i, {j, j}, x));
    }
    return force;
  }

 private:
  struct Term {
    double factor;
    std::array<int, 3> exponent;
  };
  double derivative(int i, const std::vector<int>& directions, const Vec3& x) const {
    double sum = 0;
    for (Term term : terms_[i]) {
      for (int d : directions) term.factor *= term.exponent[d]--;
      if (term.factor == 0) continue;
      for (int d = 0; d < 3; ++d) term.factor *= std::pow(x[d], term.exponent[d]);
      sum += term.factor;
    }
    return sum;
  }

  std::vector<Term> terms_[3];
  double E_;
  UnitElasticity law_;
};

}  // namespace cgcontact::test
