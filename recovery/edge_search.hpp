/// Where the edges of the contact zones run. In every patch that holds closed and open contact points the square-root
/// term of recovery/contact_edge.hpp is moved across until polynomials and term fit sigma_h best; the edge near a place is
/// the mean over the patches of both bodies around it. Measured: docs/recovery.md.
#pragma once

#include "recovery/patch_assembly.hpp"

namespace cgcontact {

/// What one patch finds.
struct EdgeSample {
  int pair;
  Vec3 origin, closed;  ///< m; unit vector, global axes
  double factor;        ///< Scales::stress per square root of a metre
  double place_weight, factor_weight;
};

class FoundEdges : public EdgeMap {
 public:
  /// `reach`: distance up to which samples count, m.
  FoundEdges(std::vector<EdgeSample> samples, double width) : samples_(std::move(samples)), width_(width) {}
  bool near(int pair, const Vec3& x, EdgePiece& piece) const override;
  const std::vector<EdgeSample>& samples() const { return samples_; }

 private:
  std::vector<EdgeSample> samples_;
  double width_;
};

/// `assemblies`: of all bodies. u: displacements of all bodies.
FoundEdges find_contact_edges(const std::vector<PatchAssembly>& assemblies, const std::vector<RecoveryBody>& bodies,
                              const RealView& u, const RecoveryOptions& options);

}  // namespace cgcontact
