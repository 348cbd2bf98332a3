/// Bodies that contact alone holds, as rigid bodies: where loads press them together, and where they are in balance.
#pragma once

#include <vector>

#include "contact/motions/free_motion.hpp"
#include "contact/solve/forces/friction.hpp"
#include "contact/solve/forces/small_zones.hpp"

namespace cgcontact {

/// Closes the contact points whose gap the rigid bodies, moved by the loads of the present step, close; opens all
/// others. Minimum of the convex energy
///   sum_contact k A min(0, gap)^2 / 2 + sum_supports k w (u . d - value)^2 / 2 - work of the loads
/// by Newton steps with exact line search; k is that of a layer some cells thick, so that about as many points close as
/// in an elastic contact. False, with the points as they were, if it has no minimum (nothing stops a body).
bool close_where_rigid_bodies_meet(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                   std::vector<ContactPair>& pairs);

/// Rigid motions of all bodies that their own supports leave free. In the outer iteration these unknowns are solved for
/// with all contact points, closed and open: the active set follows from it, and what it closes carries the loads.
class FloatingBodies {
 public:
  /// The arguments must outlive this object.
  FloatingBodies(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                 const std::vector<ContactPair>& pairs);
  /// Returns whether supports, with those of bodies that are bonded to it, leave any body free.
  bool any() const { return any_; }
  /// Returns whether its supports alone leave this body free.
  bool floats(int body) const;
  const std::vector<RigidComponent>& components() const { return components_; }

  struct Balance {
    bool found = false;
    std::vector<RigidMotion> motions;  ///< of each body, about the centre of its component; empty: all may stay
    FreeMotions unbalanced;            ///< if not found: the motion that nothing stops
  };
  /// Finds motions, from where the bodies are, that minimise the convex energy
  ///   sum over contact points of w [p* - k gap]_+^2 / (2 k) - work of the loads (those of the present step):
  /// the contact forces p = [p* - k gap]_+ then balance the loads. gap: of each group of all pairs, m; stress: p* of
  /// the points of all pairs, Pa.
  /// Groups in small zones press as those say instead; friction follows its law with the present
  /// bounds (`by_law`), or its linear forces.
  Balance balance(const std::vector<double>& gap, const std::vector<double>& stress, const SmallZones& small_zones,
                  const std::vector<FrictionGroup>& friction, bool by_law) const;
  /// Returns for each pair whether prescribed motions give its force. A floating body without loads (its own, or of
  /// those that it may touch and that float too) is squeezed, if it carries anything.
  std::vector<DisplacementDriven> displacement_driven_pairs() const;
  /// Checks whether contact carries the loads of the present step with the exact normals of the secondary bodies. On
  /// coarse cells the other points of a round body seem to lean on a plane that only its lowest one touches. Returns
  /// empty, or the motion that nothing stops.
  FreeMotions not_stopped_by_the_other_side() const;
  /// Returns whether contact without friction stops all bodies under the loads of the present step, and leaves none a
  /// motion.
  bool held_without_friction() const;
  /// Returns whether some rigid motion that supports leave free slides a pair along its faces and neither opens nor
  /// presses closed contact: else loads drive none, and what all slips follows prescribed displacements or comes apart.
  bool may_slide(const ContactPair& pair) const;
  /// Returns for each pair whether its contact opens completely as the loads move the bodies along these motions.
  std::vector<char> pairs_that_open(const FreeMotions& motions) const;

 private:
  Eigen::VectorXd load() const;
  void find_loaded();
  /// Holds squeezed bodies, which do not move along their own surfaces or those of the others: the exact pressure does
  /// no work on that, and in small zones no other point stops them.
  void hold_along_surfaces(const std::vector<SupportPoint>& supports);

  const std::vector<BodyModel>& bodies_;
  const std::vector<ContactPair>& pairs_;
  std::vector<RigidComponent> components_;
  std::vector<Eigen::Matrix<double, 6, 6>> free_;  ///< projection of a body's motions on those that are free
  std::vector<char> loaded_;                       ///< or touched by a floating body that is
  bool any_ = false;
};

}  // namespace cgcontact
