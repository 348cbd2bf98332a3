/// Gauss rules on the interval [0,1] and on triangles.
#pragma once

#include <vector>

namespace cgcontact {

/// Nodes and weights on [0,1]; exact for polynomials of degree 2 n - 1.
struct GaussRule {
  std::vector<double> node, weight;
};
constexpr int max_gauss_points = 32;
/// Requires 1 <= n <= max_gauss_points.
const GaussRule& gauss_rule(int n);

/// Rule on a triangle, weights sum to 1; position = a v0 + b v1 + (1 - a - b) v2.
struct TriangleRule {
  std::vector<double> a, b, weight;
};
/// Returns a rule exact for total degree <= `degree`, positive weights, points inside.
const TriangleRule& triangle_rule(int degree);

}  // namespace cgcontact
