/// Contact forces that follow from equilibrium alone.
#pragma once

#include <memory>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Statics of a solved scene, with the present state of its contact points.
class Statics {
 public:
  /// The arguments must outlive this object.
  Statics(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
          const std::vector<ContactPair>& pairs);
  ~Statics();

  /// Returns whether the loads give a pair's force, whatever the stiffness: whether in a virtual rigid motion of the
  /// bodies the force along `direction` (unit, global axes) does all the work of the pair, and no support and no other
  /// closed contact, nor its friction, does any. What holds motions that no load drives carries no force and does not
  /// count. False without a closed point.
  bool loads_give(int pair, const Vec3& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cgcontact
