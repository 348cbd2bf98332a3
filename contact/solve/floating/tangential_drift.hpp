/// Bodies that contact alone holds may move along their own surface, or along that of the others: the exact pressure
/// does no work on that (find_surface_motions). That of a few cells does some, which soft springs that follow the
/// motion let come to rest. A body that moves farther than the cells it touches with has gaps of where it was, which
/// mean nothing any more: then it is held where it is.
#pragma once

#include <vector>

#include "contact/motions/free_motion.hpp"
#include "contact/solve/floating/body_motion.hpp"

namespace cgcontact {

/// The motions along surfaces that the loads of the present step do not drive, of all bodies (bonded ones together)
/// that supports leave free.
class TangentialDrift {
 public:
  TangentialDrift(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                  const std::vector<ContactPair>& pairs);
  /// Returns the largest distance that a body has moved along surfaces, in its smallest cells at contact.
  double farthest(const std::vector<BodyMotion>& motions) const;
  /// Returns points that hold all these motions.
  std::vector<SupportPoint> hold(const std::vector<BodyModel>& bodies) const;

 private:
  struct DriftingBody {
    FreeMotions motions;
    double cell = 0;  ///< m
  };
  std::vector<DriftingBody> bodies_;
};

}  // namespace cgcontact
