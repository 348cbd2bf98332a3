/// Settings of the bodies' cells.
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct GeometryOptions {
  // Constants of the method.

  /// Rule of the boundary points: exact for polynomials of total degree 2 order - 1 on planes. Tractions of degree 2
  /// times shape functions on a face need 5.
  int boundary_order = 3;
  /// Cells with less of their volume are joined with a neighbour: moments below that are rounding (docs/decisions.md,
  /// "Geometry").
  double prune_fraction = 1e-12;
  /// Moments this near to those of a full cell, of its volume, are made full.
  double full_tolerance = 1e-13;

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
