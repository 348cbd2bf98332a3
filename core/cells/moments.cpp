#include "core/cells/moments.hpp"

#include <stdexcept>

#include "core/quadrature/gauss_rules.hpp"

namespace cgcontact {

namespace {

using Transfer = std::array<double, num_legendre * num_legendre>;

/// L_i(scale x + shift) = sum_j T[i * n1 + j] L_j(x).
Transfer make_transfer(double scale, double shift) {
  Transfer transfer{};
  const GaussRule& gauss = gauss_rule(num_legendre);
  for (std::size_t q = 0; q < gauss.node.size(); ++q) {
    const double x = 2 * gauss.node[q] - 1;
    double target[num_legendre], source[num_legendre];
    legendre_values(scale * x + shift, target);
    legendre_values(x, source);
    for (int i = 0; i < num_legendre; ++i)
      for (int j = 0; j <= i; ++j)
        transfer[i * num_legendre + j] += gauss.weight[q] * (2 * j + 1) * target[i] * source[j];
  }
  return transfer;
}

/// result[i,j,k] += factor sum a[i,i'] b[j,j'] c[k,k'] m[i',j',k'].
void add_transferred(const Moments& m, const Transfer& a, const Transfer& b, const Transfer& c, double factor,
                     Moments& result) {
  Moments x{}, y{};
  for (int i = 0; i < num_legendre; ++i)
    for (int j = 0; j < num_legendre; ++j)
      for (int k = 0; k < num_legendre; ++k)
        for (int l = 0; l <= k; ++l)
          x[(i * num_legendre + j) * num_legendre + k] +=
              c[k * num_legendre + l] * m[(i * num_legendre + j) * num_legendre + l];
  for (int i = 0; i < num_legendre; ++i)
    for (int j = 0; j < num_legendre; ++j)
      for (int l = 0; l <= j; ++l)
        for (int k = 0; k < num_legendre; ++k)
          y[(i * num_legendre + j) * num_legendre + k] +=
              b[j * num_legendre + l] * x[(i * num_legendre + l) * num_legendre + k];
  for (int i = 0; i < num_legendre; ++i)
    for (int l = 0; l <= i; ++l)
      for (int q = 0; q < num_legendre * num_legendre; ++q)
        result[i * num_legendre * num_legendre + q] +=
            factor * a[i * num_legendre + l] * y[l * num_legendre * num_legendre + q];
}

/// Row a: factors of the moments of degree 0 .. n-1 in the weight of the a-th Gauss point.
std::vector<double> make_weight_matrix(int n) {
  const GaussRule& gauss = gauss_rule(n);
  std::vector<double> matrix(n * n);
  for (int a = 0; a < n; ++a) {
    double l[num_legendre];
    legendre_values(2 * gauss.node[a] - 1, l);
    for (int i = 0; i < n; ++i) matrix[a * n + i] = gauss.weight[a] * (2 * i + 1) * l[i];
  }
  return matrix;
}

template <int n>
void fit_weights(const Moments& moments, const double* matrix, double* weights) {
  double x[n * n * n], y[n * n * n];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int c = 0; c < n; ++c) {
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += matrix[c * n + k] * moments[(i * num_legendre + j) * num_legendre + k];
        x[(i * n + j) * n + c] = sum;
      }
  for (int i = 0; i < n; ++i)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c) {
        double sum = 0;
        for (int j = 0; j < n; ++j) sum += matrix[b * n + j] * x[(i * n + j) * n + c];
        y[(i * n + b) * n + c] = sum;
      }
  for (int a = 0; a < n; ++a)
    for (int q = 0; q < n * n; ++q) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += matrix[a * n + i] * y[i * n * n + q];
      weights[a * n * n + q] = sum;
    }
}

}  // namespace

void fitted_weights(const Moments& moments, int n, double* weights) {
  static const std::vector<double> matrix3 = make_weight_matrix(3), matrix5 = make_weight_matrix(5);
  if (n == 3)
    fit_weights<3>(moments, matrix3.data(), weights);
  else if (n == 5)
    fit_weights<5>(moments, matrix5.data(), weights);
  else
    throw std::logic_error("fitted_weights: n must be 3 or 5");
}

Moments coarse_moments(const std::array<const Moments*, 8>& children) {
  static const Transfer transfer[2] = {make_transfer(0.5, -0.5), make_transfer(0.5, 0.5)};
  Moments result{};
  for (int child = 0; child < 8; ++child)
    if (children[child])
      add_transferred(*children[child], transfer[child & 1], transfer[child >> 1 & 1], transfer[child >> 2 & 1], 0.125,
                      result);
  return result;
}

const Moments& full_cell_moments() {
  static const Moments full = [] {
    Moments m{};
    m[0] = 8;
    return m;
  }();
  return full;
}

Moments shifted_moments(const Moments& moments, const Index3& offset) {
  const Transfer a = make_transfer(1, 2 * offset[0]), b = make_transfer(1, 2 * offset[1]),
                 c = make_transfer(1, 2 * offset[2]);
  Moments result{};
  add_transferred(moments, a, b, c, 1, result);
  return result;
}

}  // namespace cgcontact
