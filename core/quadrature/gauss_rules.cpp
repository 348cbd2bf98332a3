#include "core/quadrature/gauss_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

namespace {

/// Makes the sum of the weights 1 to the last digit.
void normalize(std::vector<double>& weight) {
  long double sum = 0;
  for (double w : weight) sum += w;
  for (double& w : weight) w = static_cast<double>(w / sum);
}

GaussRule make_gauss_rule(int n) {
  GaussRule rule;
  rule.node.resize(n);
  rule.weight.resize(n);
  for (int i = 0; i < n; ++i) {
    double x = std::cos(pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double step = p1 / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.node[n - 1 - i] = 0.5 + 0.5 * x;
    rule.weight[n - 1 - i] = 1 / ((1 - x * x) * slope * slope);
  }
  for (int i = 0; i < n / 2; ++i) {  // exactly symmetric
    rule.node[n - 1 - i] = 1 - rule.node[i];
    rule.weight[n - 1 - i] = rule.weight[i];
  }
  if (n % 2 == 1) rule.node[n / 2] = 0.5;
  normalize(rule.weight);
  return rule;
}

/// Three points with barycentric coordinates (p, p, 1 - 2 p) in every order.
void add_orbit(TriangleRule& rule, double p, double weight) {
  const double q = 1 - 2 * p;
  for (const auto& point : {std::array<double, 2>{p, p}, {p, q}, {q, p}}) {
    rule.a.push_back(point[0]);
    rule.b.push_back(point[1]);
    rule.weight.push_back(weight);
  }
}

TriangleRule make_triangle_rule(int degree) {
  TriangleRule rule;
  if (degree <= 1) {
    rule.a = rule.b = {1.0 / 3};
    rule.weight = {1};
  } else if (degree == 2) {
    add_orbit(rule, 1.0 / 6, 1.0 / 3);
  } else if (degree <= 4) {
    const double root = std::sqrt(38 - 44 * std::sqrt(0.4)), r10 = std::sqrt(10.0);
    const double w = std::sqrt(213125 - 53320 * r10);
    add_orbit(rule, (8 - r10 + root) / 18, (620 + w) / 3720);
    add_orbit(rule, (8 - r10 - root) / 18, (620 - w) / 3720);
  } else if (degree == 5) {
    const double r15 = std::sqrt(15.0);
    rule.a.push_back(1.0 / 3);
    rule.b.push_back(1.0 / 3);
    rule.weight.push_back(9.0 / 40);
    add_orbit(rule, (6 - r15) / 21, (155 - r15) / 1200);
    add_orbit(rule, (6 + r15) / 21, (155 + r15) / 1200);
  } else {  // the square collapsed to the triangle
    const GaussRule& along = gauss_rule(degree / 2 + 1);
    const GaussRule& across = gauss_rule((degree + 1) / 2 + 1);
    for (std::size_t i = 0; i < across.node.size(); ++i)
      for (std::size_t j = 0; j < along.node.size(); ++j) {
        const double u = across.node[i];
        rule.a.push_back(1 - u);
        rule.b.push_back(u * along.node[j]);
        rule.weight.push_back(2 * u * across.weight[i] * along.weight[j]);
      }
  }
  normalize(rule.weight);
  return rule;
}

}  // namespace

const GaussRule& gauss_rule(int n) {
  static const std::vector<GaussRule> rules = [] {
    std::vector<GaussRule> all(max_gauss_points + 1);
    for (int k = 1; k <= max_gauss_points; ++k) all[k] = make_gauss_rule(k);
    return all;
  }();
  if (n < 1 || n > max_gauss_points) throw std::logic_error("gauss_rule: number of points out of range");
  return rules[n];
}

const TriangleRule& triangle_rule(int degree) {
  static const std::vector<TriangleRule> rules = [] {
    std::vector<TriangleRule> all;
    for (int d = 0; d < 2 * max_gauss_points - 3; ++d) all.push_back(make_triangle_rule(d));
    return all;
  }();
  if (degree < 0 || degree >= static_cast<int>(rules.size()))
    throw std::logic_error("triangle_rule: degree out of range");
  return rules[degree];
}

}  // namespace cgcontact
