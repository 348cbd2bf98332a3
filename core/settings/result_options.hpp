/// Settings of what is said of a result: verdict, warnings, estimated errors.
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct ResultOptions {
  // Constants of the method.

  /// Cells across a zone below which its pressure and error estimate are unreliable, and recommended ones, five over
  /// half the width or the radius (docs/recovery.md, "Error figures").
  double min_cells_across = 5, wanted_cells_across = 10;
  /// The same where problems on the faces give all of the pressure (docs/accuracy.md, "The pressure on the face").
  double min_cells_on_face = 3;
  /// Cells over the thickness of a body below which its bending is not resolved, 11 to 26 % too stiff at 1.5 cells, 6
  /// to 13 % at two, and those that are recommended (docs/decisions.md, "Bodies thinner than their cells").
  double min_thickness = 1.75, wanted_thickness = 3;
  /// Fraction of the transmitted force by which the integral of the recovered pressure may be off without a warning.
  double lost_force = 0.15;
  /// Fraction of the loads on a face or a body by which the quadrature of their expressions may be off without a
  /// warning: a tenth of the usual best accuracy, 1 %.
  double lost_load = 1e-3;
  /// Fractions of a contact's force above which the result is marked: by which the forces on its bodies do not balance;
  /// which what holds otherwise unresisted motions takes. The accuracy of what is called known, and a coarse one.
  double largest_imbalance = 0.01, largest_hold = 0.05;
  /// Fraction of the integral of a contact's pressure that its estimated errors may add up to: beyond a half only the
  /// order of magnitude is known. Scenes with a known answer have 0.04 at most.
  double largest_error = 0.5;
  /// Strain whose terms of second order, which the theory leaves out, are some 5 % of those that it keeps.
  double largest_strain = 0.05;
  /// Fraction of the body's longest side: contact is looked for where the bodies were before the deformation.
  double largest_displacement = 0.1;
  /// Fraction of E: about the pressure under which a half-space is strained by 5 to 10 % (Johnson, Contact Mechanics,
  /// 4.2).
  double largest_pressure = 0.1;

  // Estimated error of the pressure (docs/recovery.md, "Error figures").

  /// Width of the Gaussian of the local mean, the larger one of both bodies' cells there.
  double mean_width = 1;
  /// Distance from the border between closed and open points, cells, within which whole groups spoil the transmitted
  /// pressure, and no polynomial follows its end.
  double spoilt_at_edge = 1.5;
  /// Fraction of the largest pressure by which the recovered pressure may leave the range of the others around it
  /// (docs/recovery.md, "Error figures": 0.044 at most in contacts that are right).
  double largest_jump = 0.1;

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
