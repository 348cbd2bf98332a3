/// Winding numbers of closed surfaces of triangles around a point: 1 inside, 0 outside, more where they overlap.
#pragma once

#include <array>
#include <vector>

#include "core/triangles/triangle_tree.hpp"

namespace cgcontact {

/// Winding numbers of two surfaces of the same triangles, which count a triangle several times, in the other sense, or
/// not at all. Clusters of triangles seen from afar count as dipoles (Barill et al. 2018, "Fast winding numbers for
/// soups and clouds", first order).
class WindingNumbers {
 public:
  static constexpr std::size_t num_surfaces = 2;
  using Passes = std::array<int, num_surfaces>;  ///< of a triangle: how often each surface has it

  WindingNumbers(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                 const std::vector<Passes>& passes);

  /// Computes them at x, with an error below 0.02 (0.013 was met on open, tangled surfaces); without the triangle
  /// `left_out`, whose both sides x is between.
  std::array<double, num_surfaces> at(const Vec3& x, int left_out) const;

 private:
  /// Seen from afar.
  struct Cluster {
    Vec3 centre = Vec3::Zero();               ///< of the triangles' areas
    double radius = 0;                        ///< to the farthest corner
    std::array<Vec3, num_surfaces> dipole{};  ///< area vectors times passes
  };

  Cluster cluster(const TriangleHalves::Node& node) const;

  const std::vector<Vec3>& points_;
  const std::vector<Triangle>& triangles_;
  const std::vector<Passes>& passes_;
  const TriangleHalves halves_;
  std::vector<Cluster> clusters_;  ///< of the nodes of halves_
};

}  // namespace cgcontact
