/// What the rest of the bodies does to the gap on a contact face: smooth, since inside the cells the bodies are
/// half-spaces. Known are means over the contact groups; between them goes the smoothest spline.
#pragma once

#include <utility>

#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// The mean of the far field over some patches, m.
struct FarMean {
  std::vector<std::pair<int, double>> patches;  ///< and what they count, 1 together
  double value = 0;
  double weight = 0;
};

/// At every patch, m: the cubic spline r on knots `h` apart that minimises
///   sum weight (mean of r - value)^2 + length^6 integral |D^3 r|^2,
/// lengths in h, the integral over the patches marked in `inside`. Even at symmetry planes.
std::vector<double> fit_far_field(const FaceGrid& grid, double h, double length, const std::vector<char>& inside,
                                  const std::vector<FarMean>& means);

}  // namespace cgcontact
