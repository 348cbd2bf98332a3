/// Where the edges of the contact zones run: from the border between closed and open contact points to the place that
/// the transmitted forces give (recovery/edge_fit.hpp), with a parabola through the places found around; in zones of
/// few cells (recovery/narrow_edges.hpp) the edge that the zone's moments give. Evidence: docs/recovery.md.
#pragma once

#include <map>
#include <memory>

#include "core/point_buckets.hpp"
#include "recovery/narrow_zone.hpp"

namespace cgcontact {

/// The edge at one place; global axes.
struct EdgeSample {
  int pair;
  int cell;                     ///< closed cell that it was found from (ContactZone::closed_cells)
  Vec3 origin, closed, normal;  ///< m; unit vectors: into the zone, outward from one of the bodies
  double inverse_width = 0;     ///< of the zone across, 1/m; 0: not known
  double factor = 0;            ///< of the term, Scales::stress per root of a metre
  std::shared_ptr<const NarrowZone> narrow = nullptr;  ///< the zone that has the edge around
};

class FoundEdges : public EdgeMap {
 public:
  /// width: m, the largest coarser cells of the pairs; scatter of the samples across the edge: widths.
  FoundEdges(std::vector<EdgeSample> samples, double width, double scatter);
  bool near(int pair, const Vec3& x, EdgePiece& piece) const override;
  bool has(int pair) const override { return first_of_pair_.count(pair) > 0; }

 private:
  std::vector<EdgeSample> samples_;
  std::map<int, std::size_t> first_of_pair_;  ///< pair -> sample
  double width_, ridge_;
  PointBuckets buckets_;
};

/// Edges of all pairs, from the contact links of the bodies.
FoundEdges find_contact_edges(const std::vector<RecoveryBody>& bodies, const Scales& scales,
                              const RecoveryOptions& options);

}  // namespace cgcontact
