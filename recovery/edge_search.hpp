/// Where the edges of the contact zones run. In every patch that holds closed and open contact points the square-root
/// term of recovery/contact_edge.hpp is moved across until polynomials and term together fit sigma_h best; a parabola
/// through the places found by the patches of both bodies around is the edge there. Evidence: docs/recovery.md.
#pragma once

#include <map>

#include "recovery/patch_assembly.hpp"

namespace cgcontact {

/// What one patch finds; global axes.
struct EdgeSample {
  int pair;
  Vec3 origin, closed, normal;  ///< m; unit vectors: into the zone, outward from the patch's own or other body
  double factor;                ///< Scales::stress per square root of a metre
  double inverse_width;         ///< of the zone across, 1/m; 0: not known
  double weight;                ///< of the factor: square of the part of the term that no polynomial carries
};

class FoundEdges : public EdgeMap {
 public:
  /// width: m, the coarser cells of the pairs.
  FoundEdges(std::vector<EdgeSample> samples, double width);
  bool near(int pair, const Vec3& x, EdgePiece& piece) const override;
  const std::vector<EdgeSample>& samples() const { return samples_; }
  /// Measures how wide the zones are across the edge.
  void measure_widths(const std::vector<PatchAssembly>& assemblies);

 private:
  using Bucket = std::array<long long, 3>;
  Bucket bucket(const Vec3& x) const;
  /// use(sample) for all samples of a pair that may lie within the reach of x.
  template <class Use>
  void each_near(int pair, const Vec3& x, const Use& use) const;

  std::vector<EdgeSample> samples_;
  double width_;
  std::map<Bucket, std::vector<int>> buckets_;
};

/// Edges of all pairs. `assemblies`: of all bodies; u: displacements of all bodies.
FoundEdges find_contact_edges(const std::vector<PatchAssembly>& assemblies, const RealView& u,
                              const RecoveryOptions& options);

}  // namespace cgcontact
