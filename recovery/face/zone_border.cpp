#include "recovery/face/zone_border.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace cgcontact {
namespace {

using QuadraticFunction = Eigen::Matrix<double, 6, 1>;  ///< of 1, x, y, x^2 / 2, x y, y^2 / 2

QuadraticFunction terms(const FacePosition& x) {
  QuadraticFunction row;
  row << 1, x[0], x[1], 0.5 * x[0] * x[0], x[0] * x[1], 0.5 * x[1] * x[1];
  return row;
}

/// Returns the weight of a patch at that fraction of the reach.
double fading(double fraction) {
  const double w = std::max(1 - fraction * fraction, 0.0);
  return w * w;
}

/// Fits the quadratic function nearest to the squares of the patches inside around a patch, positions in units of
/// `reach` from its centre; false if they do not determine one.
bool fit(const FaceGrid& grid, const std::vector<double>& square, const std::vector<char>& inside, int patch,
         double reach, QuadraticFunction& result) {
  const int rows = grid.plane_strain ? 0 : static_cast<int>(reach / grid.spacing[0]),
            columns = static_cast<int>(reach / grid.spacing[1]);
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  QuadraticFunction right = QuadraticFunction::Zero();
  int count = 0;
  for (int i = -rows; i <= rows; ++i)
    for (int j = -columns; j <= columns; ++j) {
      const int n = grid.beyond(patch, {i, j});
      if (n < 0 || !inside[n] || !(square[n] > 0)) continue;
      const FacePosition x(i * grid.spacing[0] / reach * (grid.plane_strain ? 0 : 1), j * grid.spacing[1] / reach);
      const double weight = fading(x.norm());
      if (weight == 0) continue;
      const QuadraticFunction row = terms(x);
      normal += weight * row * row.transpose();
      right += weight * square[n] * row;
      ++count;
    }
  if (grid.plane_strain)
    for (const int t : {1, 3, 4}) normal(t, t) = 1;
  if (count < (grid.plane_strain ? 4 : 12)) return false;
  result = normal.ldlt().solve(right);
  return result.allFinite();
}

/// Moves a point near the border onto it; false if the function has no zero near.
bool move_to_border(const QuadraticFunction& c, FacePosition& x, double farthest) {
  const FacePosition start = x;
  for (int round = 0; round < 8; ++round) {
    const FacePosition gradient(c[1] + c[3] * x[0] + c[4] * x[1], c[2] + c[4] * x[0] + c[5] * x[1]);
    const FacePosition step = -c.dot(terms(x)) / gradient.squaredNorm() * gradient;
    if (!step.allFinite()) return false;
    x += step;
    if ((x - start).norm() > farthest) return false;
    if (step.norm() < 1e-9) return true;
  }
  return false;
}

}  // namespace

std::vector<BorderPoint> border_of_zone(const FaceGrid& grid, const std::vector<double>& square,
                                        const std::vector<char>& inside, double reach) {
  std::vector<BorderPoint> border;
  for (int n = 0; n < grid.num_patches(); ++n) {
    if (!inside[n] || !(square[n] > 0)) continue;
    for (int a = grid.plane_strain ? 1 : 0; a < 2; ++a)
      for (const int side : {-1, 1}) {
        const int next = grid.beside(n, a)[side > 0];
        if (next < 0 || next == n || !inside[next] || square[next] > 0) continue;
        QuadraticFunction c;
        if (!fit(grid, square, inside, n, reach, c)) continue;
        FacePosition x = FacePosition::Zero();
        x[a] = side * grid.spacing[a] / reach * square[n] / (square[n] - square[next]);
        if (!move_to_border(c, x, 0.5)) continue;
        const FacePosition gradient(c[1] + c[3] * x[0] + c[4] * x[1], c[2] + c[4] * x[0] + c[5] * x[1]);
        const double slope = gradient.norm();
        const FacePosition inward = gradient / slope, along(-inward[1], inward[0]);
        Eigen::Matrix2d second;
        second << c[3], c[4], c[4], c[5];
        BorderPoint& point = border.emplace_back();
        point.position = grid.centre(n) + reach * x;
        point.inward = inward;
        point.slope = slope / reach;
        point.curvature = grid.plane_strain ? 0 : along.dot(second * along) / slope / reach;
        point.inverse_width = std::max(-0.5 * inward.dot(second * inward) / slope / reach, 0.0);
      }
  }
  return border;
}

}  // namespace cgcontact
