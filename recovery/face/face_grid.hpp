/// Patches of the contact face for the pressure of one zone: a regular grid in two coordinates along the face, m. In
/// plane strain it has one row, along the zone.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

using FacePosition = Eigen::Vector2d;  ///< along axis 0 and axis 1 of the face, m; in plane strain along axis 1 alone

/// Condition of the face at the lower end of an axis.
enum class FaceEnd {
  free,    ///< nothing: the zone ends by itself
  mirror,  ///< a symmetry plane at coordinate 0
  period   ///< symmetry planes at 0 and at the grid's other end
};

/// Line that a face around an axis of revolution is made of: distance from the axis and position along it, m, at points
/// along axis 1 of the face, equally far from each other.
struct Meridian {
  double first = 0, spacing = 1;
  std::vector<Eigen::Vector2d> points;
  double unit_radius = 1;  ///< m: patches there count for their breadth (Grid::unit_radius)

  Eigen::Vector2d at(double position) const {
    const double t = (position - first) / spacing;
    const int last = static_cast<int>(points.size()) - 2, k = std::clamp(static_cast<int>(std::floor(t)), 0, last);
    return points[k] + (t - k) * (points[k + 1] - points[k]);
  }
};

struct FaceGrid {
  std::array<int, 2> size{1, 1};            ///< patches along each axis; (rows, columns)
  std::array<double, 2> spacing{1, 1};      ///< m
  FacePosition low = FacePosition::Zero();  ///< corner of the first patch, m
  std::array<FaceEnd, 2> end{FaceEnd::free, FaceEnd::free};
  bool plane_strain = false;
  std::shared_ptr<const Meridian> meridian;  ///< of bodies of revolution, as if in plane strain; else none

  int num_patches() const { return size[0] * size[1]; }
  FacePosition centre(int patch) const {
    const int row = patch / size[1], column = patch % size[1];
    return low + FacePosition((row + 0.5) * spacing[0], (column + 0.5) * spacing[1]);
  }
  /// Returns the area of a patch, m^2; in plane strain m, per thickness.
  double area() const { return plane_strain ? spacing[1] : spacing[0] * spacing[1]; }
  /// Returns the weight of a patch's area: in proportion to the radius around an axis of revolution, else 1.
  double ring(int patch) const {
    return meridian ? std::abs(meridian->at(centre(patch)[1])[0]) / meridian->unit_radius : 1;
  }
  /// Returns the number of the patch `steps` beyond another one along an axis, in its image behind a symmetry plane
  /// too; -1: beyond a free end.
  int beyond(int patch, std::array<int, 2> steps) const {
    std::array<int, 2> at{patch / size[1], patch % size[1]};
    for (int a = 0; a < 2; ++a) {
      at[a] += steps[a];
      if (at[a] < 0 && end[a] != FaceEnd::free) at[a] = -1 - at[a];
      if (at[a] >= size[a] && end[a] == FaceEnd::period) at[a] = 2 * size[a] - 1 - at[a];
      if (at[a] < 0 || at[a] >= size[a]) return -1;
    }
    return at[0] * size[1] + at[1];
  }
  /// Returns the patches `steps` before and after another one along an axis, as `beyond` has them.
  std::array<int, 2> beside(int patch, int axis, int steps = 1) const {
    std::array<int, 2> forward{0, 0}, backward{0, 0};
    forward[axis] = steps;
    backward[axis] = -steps;
    return {beyond(patch, backward), beyond(patch, forward)};
  }
  /// Returns row and column of the patch at a point, in its image behind a symmetry plane too; beyond free ends they
  /// are none.
  std::array<int, 2> index_of(const FacePosition& position) const {
    const FacePosition x = folded(position);
    std::array<int, 2> index{0, 0};
    for (int a = plane_strain ? 1 : 0; a < 2; ++a)
      index[a] = static_cast<int>(std::floor((x[a] - low[a]) / spacing[a]));
    return index;
  }
  /// Maps a point behind a symmetry plane to its image.
  FacePosition folded(FacePosition x) const {
    for (int a = 0; a < 2; ++a) {
      if (end[a] == FaceEnd::free) continue;
      x[a] = std::abs(x[a]);
      const double high = size[a] * spacing[a];
      if (end[a] == FaceEnd::period && x[a] > high) x[a] = 2 * high - x[a];
    }
    return x;
  }
};

}  // namespace cgcontact
