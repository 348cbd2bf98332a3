/// Patches of one zone on the contact face: where they lie, how far the other body is, whose groups they are.
#pragma once

#include "contact/results/face_problems/pair_groups.hpp"
#include "core/base/numbers/point_buckets.hpp"

namespace cgcontact {

class ZonePatches {
 public:
  /// Makes the patches. closed: groups of the zone; planes: symmetry planes of both bodies. None: all points around are
  /// closed, the face has no chart, or the zone is so wide that its problem would take longer than the bodies'.
  static std::optional<ZonePatches> make(const SolvedState& state, const PairGroups& face,
                                         const std::vector<int>& closed, const std::vector<SymmetryPlane>& planes,
                                         const FaceOptions& options);

  const FaceGrid& grid() const { return grid_; }
  const ZoneChart& chart() const { return *chart_; }
  double h() const { return h_; }                  ///< m, the larger cells of both bodies at the zone
  double thickness() const { return thickness_; }  ///< m, of plane strain; else 1
  bool is_closed(int point) const { return face_.groups()[pair_.points.group(point)].closed(); }
  /// Return contact points of the zone and around, and their coordinates on the face.
  const std::vector<int>& points() const { return near_; }
  const std::vector<Vec3>& coordinates() const { return coordinates_; }
  /// Coordinates as a point for searches.
  Vec3 flat(FacePosition x) const { return {grid_.plane_strain ? 0.0 : x[0], x[1], 0}; }

  // By patch.

  /// Returns groups and their shares of the patch, none: it is not on both faces.
  const std::vector<std::vector<std::pair<int, double>>>& shares() const { return shares_; }
  const std::vector<double>& distance() const { return distance_; }  ///< m, of the undeformed faces
  const std::vector<double>& cosine() const { return cosine_; }  ///< between the normals of the primary face and chart
  /// Heights of the primary face (0) and of the other one (1) above the chart, m.
  const std::vector<double>& height(int side) const { return height_[side]; }

 private:
  ZonePatches(const SolvedState& state, const PairGroups& face, const std::vector<int>& closed,
              const std::vector<SymmetryPlane>& planes, const FaceOptions& options);
  bool gather_points();
  double zone_area() const;
  bool lay_grid();
  void lay_meridian();
  void assign_points();
  std::vector<int> groups_near(int patch) const;
  std::vector<std::pair<int, double>> shares_of(int patch, const FacePosition& position, const Vec3& x,
                                                const OppositePoint& opposite) const;
  void project_patches();

  /// Cell of a group, in its body's grid coordinates.
  struct Cell {
    Vec3 low, high;
    bool primary;
    /// Returns whether it holds the point of the body that it belongs to.
    bool holds(const Vec3& of_primary, const Vec3& of_secondary) const {
      const Vec3& x = primary ? of_primary : of_secondary;
      return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    }
  };

  const SolvedState& state_;
  const PairGroups& face_;
  const ContactPair& pair_;
  const std::vector<int>& closed_;
  const FaceOptions& options_;
  double h_ = 0, thickness_ = 1;
  int across_ = -1;
  std::vector<SymmetryPlane> planes_;
  std::vector<int> near_;
  std::vector<Cell> cells_;  ///< of all groups
  std::optional<ZoneChart> chart_;
  FaceGrid grid_;
  std::optional<PointBuckets> points_;  ///< near_, by coordinates_
  std::vector<Vec3> coordinates_;
  std::vector<int> nearest_;  ///< contact point nearest to each patch; -1: it is on neither face
  std::vector<std::vector<std::pair<int, double>>> shares_;
  std::vector<double> distance_, cosine_;
  std::array<std::vector<double>, 2> height_;
};

}  // namespace cgcontact
