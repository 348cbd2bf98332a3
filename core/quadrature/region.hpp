/// Region of a square [0,w]^2 where a boolean of the signs of several functions holds: quadratic polynomials (sections
/// of surfaces by a plane) or values of one in space on a curved surface given as a graph over the square. Convention
/// everywhere: a function < 0 is "inside" (its bit is set), >= 0 is outside.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Finds the real roots of a x^2 + b x + c in ascending order; returns their number (0 if all coefficients vanish).
int quadratic_roots(double a, double b, double c, double roots[2]);

/// c + g.u + u^T q u.
struct Quadric {
  double c = 0;
  Vec3 g = Vec3::Zero();
  Mat3 q = Mat3::Zero();
  double operator()(const Vec3& u) const { return c + u.dot(g + q * u); }
  Vec3 gradient(const Vec3& u) const { return g + 2.0 * (q * u); }
};

/// c + s_ s + t_ t + ss s^2 + st s t + tt t^2.
struct Conic {
  double c = 0, s = 0, t = 0, ss = 0, st = 0, tt = 0;
  double operator()(double x, double y) const { return c + x * (s + ss * x + st * y) + y * (t + tt * y); }
  bool is_linear() const { return ss == 0 && st == 0 && tt == 0; }
  /// Returns -1: negative on the whole square [0,w]^2, +1: not negative on it, 0: not known.
  int sign_on_square(double w) const;
};

/// Quadric as a graph u[2] = height(u[0], u[1]); the derivative along u[2] has the given sign.
struct Graph {
  Quadric quadric;
  double sign = 1;
  /// Returns NaN where the graph does not exist.
  double height(double s, double t) const;
};

/// One function whose sign is a bit of the mask.
struct RegionFunction {
  std::uint64_t bit = 0;
  bool on_graph = false;
  Conic conic;      ///< if not on_graph
  Quadric quadric;  ///< if on_graph: its value at (s, t, height(s,t)); linear where q = 0
  bool is_divider = false;
};

/// Predicate of the region to keep. Bits of the mask: surfaces (low bits), ownership, dividers.
struct RegionPredicate {
  const std::vector<unsigned char>* table = nullptr;  ///< inside or not for every combination of the surface bits
  std::uint64_t surface_mask = 0;
  std::uint64_t facet = 0;             ///< bit of the surface whose facet is sought; 0: the region itself
  std::uint64_t lower = 0, upper = 0;  ///< bits of the facet's surface on the two faces of the cell
  std::uint64_t divider_mask = 0;
  /// Returns for a region: 1 inside, else 0. Facet: 1 if the body lies on the inner side of the surface, -1 if on the
  /// outer side, 0 if this point of the surface is not on the body's boundary or not between the two faces.
  int operator()(std::uint64_t mask) const;
};

struct RegionPoint {
  double s, t, weight;
  int value;           ///< of the predicate
  std::uint64_t mask;  ///< divider bits: points with equal value and mask form a group
};

/// Number of points: where all functions that matter are linear, the region is cut into convex polygons (triangles,
/// parallelograms) with rules exact for the total degree `polygon_degree`; else nested rules.
struct RegionRule {
  int polygon_degree = 5;
  int nodes_s = 10, nodes_t = 10;
};

struct Region {
  double width = 1;
  std::vector<RegionFunction> functions;
  RegionPredicate predicate;
  std::uint64_t fixed_bits = 0;  ///< bits that are set on the whole square
  Graph graph;                   ///< used if a function is on_graph
  bool has_graph = false;

  /// Adds a function unless its sign is the same on the whole square (then its bit is fixed).
  void add(const RegionFunction& function);
};

}  // namespace cgcontact
