/// One patch ready to be solved: unconstrained fits, constraint rows, what kind it is.
#pragma once

#include <vector>

#include "recovery/patch/patches.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact {

/// What a patch touches; a patch that touches several things is of the last kind in this list.
enum class PatchKind : char { interior, boundary, loaded, symmetry, support, contact, contact_edge };
constexpr int num_patch_kinds = 7;
constexpr const char* patch_kind_names[num_patch_kinds] = {"interior", "boundary", "loaded",      "symmetry",
                                                           "support",  "contact",  "contact_edge"};

/// What became of a patch; a patch that is several of these counts as the last one.
enum class PatchStatus : char {
  exact,           ///< all rows are met
  truncated,       ///< redundant rows were dropped, the others are met
  degree_lowered,  ///< not enough material for the quadratic polynomial that was asked for: a linear one
  conflicting,     ///< data that contradict each other, met in least squares
  uncoupled,       ///< closed contact without an auxiliary patch: zero shear only
  edge_unclear,    ///< the contact ends in the patch, and no term follows how
  balanced,        ///< the pressure did not carry the transmitted forces and was changed until it does
  singular,        ///< not enough material for the polynomial: mean stress, no constraints
};
constexpr int num_patch_statuses = 8;
constexpr const char* patch_status_names[num_patch_statuses] = {
    "exact", "truncated", "degree_lowered", "conflicting", "uncoupled", "edge_unclear", "balanced", "singular"};

/// What the polynomial of a node is to be.
struct PatchPolynomial {
  char degree = 1;
  char rings = 1;  ///< of cells around the node that it is fitted to; degree 1: one
};

/// One constraint at a point: sum over the bodies of weight : sigma(centre + place) = value.
struct PatchRow {
  double weight[2][6] = {};  ///< of xx, yy, zz, xy, yz, zx; own body, auxiliary body (zero: no part)
  double place[2][3] = {};   ///< relative to the polynomial's centre, in its unit
  double value = 0;          ///< Scales::stress
  bool firm = false;         ///< holds to rounding, whatever the other rows ask for: no pressure on an open face
};

/// A polynomial fit before constraints: mass matrix and coefficients about a centre.
struct PatchFit {
  static constexpr int most_terms = Polynomial<2>::num_terms;
  int degree = 1;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_terms, most_terms> mass;  ///< terms x terms
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6 * most_terms, 1> a;                       ///< component, term
  Vec3 centre;                                                                            ///< grid coordinates
  double unit = 1;      ///< of the polynomial's coordinates, grid coordinates: size of the largest cells of the patch
  double variance = 0;  ///< mean square of what the polynomials leave of sigma_h; 0: not known
  bool regular = false;

  /// Coordinates of the polynomial at a place (grid coordinates).
  Vec3 place(const Vec3& x) const { return (x - centre) / unit; }
  int terms() const { return degree == 1 ? num_terms : most_terms; }
};

}  // namespace cgcontact
