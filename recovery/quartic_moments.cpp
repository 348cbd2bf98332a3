#include "recovery/quartic_moments.hpp"

namespace cgcontact {
namespace {

constexpr int degree = 4, n = degree + 1;

/// Exponents of the ten terms of Polynomial<2>.
constexpr int exponents[10][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                  {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};

/// x^i by Legendre polynomials of 2 x, |x| <= 1/2.
constexpr double by_legendre[n][n] = {{1, 0, 0, 0, 0},
                                      {0, 1. / 2, 0, 0, 0},
                                      {1. / 12, 0, 2. / 12, 0, 0},
                                      {0, 3. / 40, 0, 2. / 40, 0},
                                      {7. / 560, 0, 20. / 560, 0, 8. / 560}};

struct Tables {
  int index[n][n][n];  ///< -1: degree above 4
  int product[10][10];
  Tables() {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) index[i][j][k] = i + j + k <= degree ? quartic_index(i, j, k) : -1;
    for (int s = 0; s < 10; ++s)
      for (int t = 0; t < 10; ++t) {
        const int *a = exponents[s], *b = exponents[t];
        product[s][t] = index[a[0] + b[0]][a[1] + b[1]][a[2] + b[2]];
      }
  }
};

const Tables& tables() {
  static const Tables tables;
  return tables;
}

/// Shifts a row of moments 0 .. size-1 along one direction.
template <class At>
void shift_row(double d, int size, const At& at) {
  for (int s = 1; s < size; ++s)
    for (int i = size - 1; i >= s; --i) at(i) += d * at(i - 1);
}

}  // namespace

QuarticMoments quartic_moments(const Moments& m) {
  const Tables& table = tables();
  QuarticMoments out{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j)
      for (int k = 0; i + j + k < n; ++k) {
        double sum = 0;
        for (int a = i % 2; a <= i; a += 2)
          for (int b = j % 2; b <= j; b += 2)
            for (int c = k % 2; c <= k; c += 2)
              sum += by_legendre[i][a] * by_legendre[j][b] * by_legendre[k][c] * m[(a * n + b) * n + c];
        out[table.index[i][j][k]] = sum / 8;
      }
  return out;
}

void shift_moments(const double d[3], QuarticMoments& m) {
  const auto& index = tables().index;
  const auto along = [&](int axis, const auto& at) {
    for (int a = 0; a < n; ++a)
      for (int b = 0; a + b < n; ++b) shift_row(d[axis], n - a - b, [&](int i) -> double& { return m[at(a, b, i)]; });
  };
  along(0, [&](int a, int b, int i) { return index[i][a][b]; });
  along(1, [&](int a, int b, int i) { return index[a][i][b]; });
  along(2, [&](int a, int b, int i) { return index[a][b][i]; });
}

QuadraticMass quadratic_mass(const QuarticMoments& moments) {
  const auto& product = tables().product;
  QuadraticMass mass;
  for (int s = 0; s < 10; ++s)
    for (int t = 0; t < 10; ++t) mass(s, t) = moments[product[s][t]];
  return mass;
}

}  // namespace cgcontact
