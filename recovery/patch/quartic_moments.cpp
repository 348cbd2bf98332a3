#include "recovery/patch/quartic_moments.hpp"

namespace cgcontact {
namespace {

constexpr int n = 5;  // of powers

/// x^i by Legendre polynomials of 2 x, |x| <= 1/2.
constexpr double by_legendre[n][n] = {{1, 0, 0, 0, 0},
                                      {0, 1. / 2, 0, 0, 0},
                                      {1. / 12, 0, 2. / 12, 0, 0},
                                      {0, 3. / 40, 0, 2. / 40, 0},
                                      {7. / 560, 0, 20. / 560, 0, 8. / 560}};

}  // namespace

QuarticMoments quartic_moments(const Moments& m) {
  QuarticMoments out{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j)
      for (int k = 0; i + j + k < n; ++k) {
        double sum = 0;
        for (int a = i % 2; a <= i; a += 2)
          for (int b = j % 2; b <= j; b += 2)
            for (int c = k % 2; c <= k; c += 2)
              sum += by_legendre[i][a] * by_legendre[j][b] * by_legendre[k][c] * m[(a * n + b) * n + c];
        out[quartic_index(i, j, k)] = sum / 8;
      }
  return out;
}

QuadraticMass quadratic_mass(const double* moments) {
  QuadraticMass mass;
  for (int s = 0; s < 10; ++s)
    for (int t = 0; t < 10; ++t) mass(s, t) = moments[index_of_product(s, t)];
  return mass;
}

}  // namespace cgcontact
