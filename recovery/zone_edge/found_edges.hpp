/// The edges of the contact zones as places on them, with a parabola through those around; in zones of few cells
/// (recovery/zone_edge/narrow_zone.hpp) the edge that the zone's moments give.
#pragma once

#include <map>
#include <memory>

#include "core/base/point_buckets.hpp"
#include "recovery/zone_edge/narrow_zone.hpp"

namespace cgcontact {

/// The edge at one place; global axes.
struct EdgeSample {
  int pair;
  int cell;                     ///< closed cell that it was found from (ContactZone::closed_cells)
  Vec3 origin, closed, normal;  ///< m; unit vectors: into the zone, outward from one of the bodies
  double inverse_width = 0;     ///< of the zone across, 1/m; 0: not known
  double factor = 0;            ///< of the term, Scales::stress per root of a metre
  std::shared_ptr<const NarrowZone> narrow = nullptr;  ///< the zone that has the edge around
  double cell_size = 0;                                ///< m, of the larger cells of both bodies there
  bool in_strip = false;  ///< the face is a strip of few cells there, and the edge runs straight across it
};

class FoundEdges : public EdgeMap {
 public:
  explicit FoundEdges(std::vector<EdgeSample> samples, const EdgeOptions& options = {});
  bool near(int pair, const Vec3& x, EdgePiece& piece) const override;
  bool has(int pair) const override { return first_of_pair_.count(pair) > 0; }

  /// Edges of one zone are those nearer to each other than near() reaches, and so on.
  std::size_t num_zones() const { return num_zones_; }
  /// Number of the zone whose edge is nearest to x (m, global axes), -1: there is none in reach.
  int zone(int pair, const Vec3& x) const;
  /// The edges of all zones but those marked.
  FoundEdges without(const std::vector<char>& zones) const;

 private:
  double reach() const { return 4 * options_.smoothing; }  ///< cells: samples beyond do not count
  const EdgeSample* nearest(int pair, const Vec3& x) const;
  void number_zones();

  EdgeOptions options_;
  std::vector<EdgeSample> samples_;
  std::vector<int> zone_;  ///< of samples
  std::size_t num_zones_ = 0;
  std::map<int, std::size_t> first_of_pair_;  ///< pair -> sample
  PointBuckets buckets_;
};

}  // namespace cgcontact
