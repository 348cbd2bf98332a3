/// Gap on a contact face due to the rest of the bodies: smooth, since inside the cells the bodies are half-spaces.
/// Known are means over the contact groups; between them goes the smoothest spline that meets them.
#pragma once

#include <Eigen/Sparse>
#include <utility>

#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// Mean of the far field over some patches, m.
struct FarMean {
  std::vector<std::pair<int, double>> patches;  ///< and what they count, 1 together
  double value = 0;
  double error = 1;  ///< by which the value may be off, m
  double weight = 0;
};

/// The cubic spline r on knots `h` apart that minimises, for details of a length (in h) that is chosen last,
///   E^2 sum weight ((mean of r - value) / error)^2 + length^6 integral |D^3 r|^2,
/// E a mean of the errors (sum weight E^2 / error^2 = sum weight), the integral in h, over the region of the face
/// marked in `inside`. Even at symmetry planes. Where no plane is, the knots lie in the middle of the face, so that its
/// mirror image has the mirrored field.
class FarField {
 public:
  FarField(const FaceGrid& grid, double h, const std::vector<char>& inside, const std::vector<FarMean>& means);

  /// Returns the field at every patch, m.
  std::vector<double> with_details(double length) const;

  /// Returns the longest details, within the given bounds, that meet the means within their errors (Morozov 1966): sum
  /// weight ((mean of r - value) / error)^2 <= sum weight.
  double longest_details(double shortest, double longest) const;

 private:
  Eigen::VectorXd coefficients(double length) const;

  const FaceGrid& grid_;
  double h_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows_;  ///< (means, splines): means of the splines
  Eigen::VectorXd values_, weights_;                   ///< of the means; with their errors
  Eigen::SparseMatrix<double> known_, bent_;           ///< of both sums
  double allowed_ = 0;                                 ///< E^2 sum weight
};

}  // namespace cgcontact
