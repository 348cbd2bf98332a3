/// The border of a contact zone, where the square of the pressure on the patches is zero.
#pragma once

#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// Point of the border; lengths along the face, m.
struct BorderPoint {
  FacePosition position = FacePosition::Zero();  ///< on the border
  FacePosition inward = FacePosition::UnitY();   ///< unit direction into the zone
  double curvature = 0;                          ///< of the border, 1/m; negative around a convex zone
  double slope = 0;                              ///< of the square of the pressure across the border, Pa^2 / m
  double inverse_width = 0;  ///< 1 / width at which a parabola across the border falls to zero again, 1/m; 0: wider
};

/// Returns points of the border where the square changes its sign between neighbouring patches of the faces: zeros of
/// the quadratic function fitted to the squares of the patches inside within `reach` (m), exact for Hertz's ellipses.
/// square: Pa^2, negative outside; inside: 1 at patches of the faces. None at ends of the faces, where the pressure
/// does not fall to zero.
std::vector<BorderPoint> border_of_zone(const FaceGrid& grid, const std::vector<double>& square,
                                        const std::vector<char>& inside, double reach);

}  // namespace cgcontact
