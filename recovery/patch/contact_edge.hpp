/// Stress at the edge of a contact zone. Where a frictionless contact opens the pressure ends like the square root of
/// the distance, which no polynomial follows: the first term of Williams's expansion (half of a mode I crack: no shear
/// on the ligament, no traction on the open side) stands beside the polynomials, with the same factor in both bodies.
/// The paper omits the edge; Rodenas et al. split sigma* so into a singular and a smooth term at crack tips. Evidence:
/// docs/recovery.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/surface.hpp"

namespace cgcontact {

/// Returns the pressure of the unit term at a distance inside the edge of a zone of the given 1 / width; zero outside.
inline double edge_root(double inside, double inverse_width) {
  return std::sqrt(std::max(inside * (1 - inside * inverse_width), 0.0));
}

/// Segment of the edge, a parabola, seen from one body; grid coordinates of that body.
struct ContactEdge {
  Vec3 origin = Vec3::Zero();   ///< on the edge
  Vec3 closed = Vec3::UnitX();  ///< unit tangent of the surface, across the edge into the contact zone
  Vec3 along = Vec3::UnitY();   ///< unit tangent of the surface, along the edge
  double curvature = 0;         ///< of the edge, 1 / cell; negative around a convex zone
  Surface surface;              ///< contact face
  double orientation = 1;       ///< outward normal = orientation * gradient of the signed distance
  double inverse_width = 0;     ///< 1 / width of the zone across, cell; 0: not known or wide
  double scale = 1;             ///< unit of length of the term, per cell of this body
  double poisson_ratio = 0;     ///< plane strain along the edge

  /// Returns the distance from the edge into the closed side (negative: open), unit of length of the term.
  double inside(const Vec3& x) const {
    const Vec3 d = x - origin;
    const double t = along.dot(d);
    return scale * (closed.dot(d) + 0.5 * curvature * t * t);
  }

  /// Returns the normal traction of the unit term on the face at a distance inside, unit of length of the term.
  double root(double inside) const { return edge_root(inside, inverse_width / scale); }

  /// Stress (xx, yy, zz, xy, yz, zx; grid axes) of the unit term: normal traction sqrt(inside) in the zone, none
  /// outside, no shear. In equilibrium where face and edge are plane and straight; else up to the distance over the
  /// radius.
  void stress(const Vec3& x, double s[6]) const;
};

/// Evaluates the term at depth y >= 0 below the face and x inside the edge, in the frame (across into the zone, inward
/// normal, along the edge): components across, normal, shear. Westergaard's form Re Z - y Im Z', Re Z + y Im Z', -y Re
/// Z' with Z = sqrt(z - c z^2), z = x + i y, c = 1 / width: Hertz's plane contact up to a linear polynomial, and
/// sqrt(z) for c = 0. Along the edge acts nu (across + normal).
inline void edge_term(double x, double y, double c, double& across, double& normal, double& shear) {
  const double wr = x - c * (x * x - y * y), wi = y * (1 - 2 * c * x), size = std::sqrt(wr * wr + wi * wi);
  const double real = std::sqrt(std::max(size + wr, 0.0) / 2);
  const double imaginary = std::copysign(std::sqrt(std::max(size - wr, 0.0) / 2), wi);
  const double a = 1 - 2 * c * x, b = -2 * c * y, factor = y / (2 * size + 1e-300);
  const double slope_imaginary = factor * (b * real - a * imaginary);
  across = real - slope_imaginary;
  normal = real + slope_imaginary;
  shear = -factor * (a * real + b * imaginary);
}

/// The terms beside the polynomials of some nodes of a body.
struct EdgeTerms {
  struct Term {
    ContactEdge edge;
    double factor;  ///< Scales::stress per square root of the unit of length; negative where the bodies press
  };
  std::vector<int> row_of_node;  ///< node -> row of terms, or -1; empty: no node has one
  std::vector<Term> terms;

  void add(int node, std::size_t num_nodes, const Term& term) {
    if (row_of_node.empty()) row_of_node.assign(num_nodes, -1);
    row_of_node[node] = static_cast<int>(terms.size());
    terms.push_back(term);
  }
  const Term* of_node(int node) const {
    if (row_of_node.empty() || row_of_node[node] < 0) return nullptr;
    return &terms[row_of_node[node]];
  }
};

}  // namespace cgcontact
