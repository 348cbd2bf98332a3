/// Settings of the contact search; those of a single pair are in ContactSpec.
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct ContactOptions {
  // Constants of the method; figures in docs/decisions.md, "Supports and contact" and "Contact search".

  /// Order of the rule on the coarser body's boundary, which both grids divide: exact for the products of both bodies'
  /// trilinear shape functions, which the patch test needs.
  int quadrature_order = 2;
  /// A pair sees its closest points and that much beyond them, of the larger cells and of the smaller body's longest
  /// extent, whichever is more. Larger approaches are found after the solve (Simulation::run).
  double reach_in_cells = 2, reach_in_extents = 0.05;
  /// Gap of bonded faces, in the larger cells, up to which they are tied; from `bond_gap` on with a warning.
  double bond_reach = 0.25, bond_gap = 0.01;
  /// Largest overlap relative to the smaller body's longest extent: small strain is off by as much.
  double largest_overlap = 0.1;

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
