/// Contact law without friction at a point: pressure by gap. A law along the surface stands beside this one, with the
/// pressure from here.
#pragma once

#include <Kokkos_Macros.hpp>

namespace cgcontact {

/// p = [p* - k g]_+ with the lagged pressure p* (Pa) and the gap g (m, overlaps negative); bonded it also pulls, p = p*
/// - k g. Any units common to p*, k g and p.
struct NormalContact {
  double k = 0;         ///< Pa/m
  bool bonded = false;  ///< also pulls

  /// Returns the pressure of a point that is taken for closed: less than zero, it would pull.
  KOKKOS_INLINE_FUNCTION double closed_pressure(double lagged, double gap) const { return lagged - k * gap; }
  /// Returns whether a point is closed that would press with this.
  KOKKOS_INLINE_FUNCTION bool is_closed(double closed_pressure) const { return bonded || closed_pressure > 0; }
  KOKKOS_INLINE_FUNCTION double pressure(double lagged, double gap) const {
    const double p = closed_pressure(lagged, gap);
    return is_closed(p) ? p : 0;
  }
  /// Returns -dp/dg.
  KOKKOS_INLINE_FUNCTION double stiffness(double lagged, double gap) const {
    return is_closed(closed_pressure(lagged, gap)) ? k : 0;
  }
  /// Returns the energy per area, whose derivative to the gap is -p; convex.
  KOKKOS_INLINE_FUNCTION double energy(double lagged, double gap) const {
    const double p = pressure(lagged, gap);
    return p * p / (2 * k);
  }
};

}  // namespace cgcontact
