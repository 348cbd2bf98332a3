/// Coulomb's law at a point, with the bound that the pressure gives lagged: the traction along the surface by radial
/// return.
#pragma once

#include <Kokkos_Macros.hpp>
#include <cmath>

namespace cgcontact {

/// Fraction of k that a point which slips keeps in the matrix, so that a body which slides leaves it regular.
/// docs/decisions.md: less converges sooner close to sliding, but shows it less well.
constexpr double held_in_slip = 1e-4;

/// tau = z where |z| <= b (it sticks), else b z/|z| (it slips), with the trial z = t* - k (s - s_p): t* lagged shear
/// (Pa), s slip of the second body against the first (m), s_p where it stuck last (m), b = mu p (Pa). What acts on the
/// second body. The energy per area, whose derivative to s is -tau, is convex while t*, s_p and b stay.
struct TangentialContact {
  double k = 0;          ///< Pa/m
  double z[2] = {0, 0};  ///< Pa

  KOKKOS_INLINE_FUNCTION TangentialContact(double stiffness, const double lagged[2], const double slip[2],
                                           const double reference[2])
      : k(stiffness) {
    for (int i = 0; i < 2; ++i) z[i] = lagged[i] - k * (slip[i] - reference[i]);
  }
  KOKKOS_INLINE_FUNCTION double size() const { return std::sqrt(z[0] * z[0] + z[1] * z[1]); }
  KOKKOS_INLINE_FUNCTION bool sticks(double bound) const { return size() <= bound; }
  /// Returns the fraction of z that is carried.
  KOKKOS_INLINE_FUNCTION double carried_fraction(double bound) const {
    const double most = size();
    return most <= bound ? 1 : bound / most;
  }
  /// Returns -d tau_i / d s_j of a point that slips is k |tau|/|z| (I - d d^T) with d = z/|z|; of one that sticks k I.
  /// `held`: fraction of k that one which slips keeps, so that a body which slides leaves the matrix regular.
  KOKKOS_INLINE_FUNCTION double stiffness(double bound, double held, int i, int j) const {
    const double most = size(), one = i == j ? 1 : 0;
    if (most <= bound) return k * one;
    return k * (bound / most * (one - z[i] * z[j] / (most * most)) + held * one);
  }
};

}  // namespace cgcontact
