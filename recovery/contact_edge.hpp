/// Stress at the edge of a contact zone. Where a frictionless contact opens the pressure ends like the square root of
/// the distance, which no polynomial follows: the first term of Williams's expansion (half of a mode I crack: zero shear
/// on the ligament, no traction on the open side) is fitted beside the polynomial, with the same factor in both bodies.
#pragma once

#include <vector>

#include "core/csg.hpp"

namespace cgcontact {

/// A straight piece of the edge seen from one body; grid coordinates of that body.
struct ContactEdge {
  Vec3 origin = Vec3::Zero();   ///< on the edge
  Vec3 closed = Vec3::UnitX();  ///< unit tangent of the surface, across the edge into the contact zone
  Surface surface;              ///< contact face
  double orientation = 1;       ///< outward normal = orientation * gradient of the signed distance
  double scale = 1;             ///< unit of length of the term, per cell of this body
  double poisson_ratio = 0;     ///< plane strain along the edge

  /// Distance from the edge into the closed side (negative: open), unit of length of the term.
  double inside(const Vec3& x) const { return scale * closed.dot(x - origin); }
  /// Stress (xx, yy, zz, xy, yz, zx; grid axes) of the unit term: normal traction sqrt(inside) in the zone, none outside,
  /// no shear. In equilibrium where the face is plane; on a curved one up to depth over radius.
  void stress(const Vec3& x, double s[6]) const;
};

/// The terms beside the polynomials of some nodes of a body.
struct EdgeTerms {
  struct Term {
    ContactEdge edge;
    double factor;  ///< Scales::stress per square root of the unit of length; negative where the bodies press
  };
  std::vector<int> row_of_node;  ///< node -> row of terms, or -1; empty: no node has one
  std::vector<Term> terms;

  const Term* of_node(int node) const {
    if (row_of_node.empty() || row_of_node[node] < 0) return nullptr;
    return &terms[row_of_node[node]];
  }
};

}  // namespace cgcontact
