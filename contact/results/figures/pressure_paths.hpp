/// Points on the contact faces, and the lines on them along which the pressure is drawn.
#pragma once

#include <optional>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Projection to the contact faces of a run.
class FaceProjection {
 public:
  FaceProjection(const SolvedState& state, const Results& results);

  /// Returns the point of a body's contact faces nearest to `anywhere`: on the surface of the nearest contact row,
  /// which is a cell away at most; in plane strain the position across is ignored. pair: of that row, or -1: any.
  std::optional<ContactRow> operator()(int body, int pair, const Vec3& anywhere) const;

 private:
  const SolvedState& state_;
  const Results& results_;
  std::vector<PointBuckets> rows_;  ///< of each body, m
};

/// Sets Results::path. With a path in the scene: 401 points of that line, projected to the faces of every body. Else
/// for every pair with pressure a line on the face through the largest pressure, along the coordinate axis (or else the
/// main direction) in which the zone is longest, a little beyond both ends or to the end of the face; s is zero at the
/// largest pressure.
void fill_paths(const SolvedState& state, Results& results);

}  // namespace cgcontact
