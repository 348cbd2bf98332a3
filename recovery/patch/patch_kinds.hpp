/// Kinds and states of patches.
#pragma once

namespace cgcontact {

/// Kind of a patch by what it touches; a patch that touches several things is of the last kind in this list.
enum class PatchKind : char { interior, boundary, loaded, symmetry, support, contact, contact_edge };
constexpr int num_patch_kinds = 7;
constexpr const char* patch_kind_names[num_patch_kinds] = {"interior", "boundary", "loaded",      "symmetry",
                                                           "support",  "contact",  "contact_edge"};

/// Outcome of a patch; one with several counts as the last one.
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

/// Description of a node's polynomial.
struct PatchPolynomial {
  char degree = 1;
  char rings = 1;  ///< of cells around the node that it is fitted to; degree 1: one
};

}  // namespace cgcontact
