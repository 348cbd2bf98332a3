/// Contact zones smaller than the cells, between bodies whose motions are prescribed: groups press by their mean gap,
/// which such a zone hardly changes, so their force follows from the gap inside the group instead.
///
/// Indentation of an elastic half-space by a convex punch of any shape: with V the volume and A the area in which the
/// undeformed bodies overlap at the approach delta,
///   F = 1.07 E* V / sqrt(A),    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2,
/// within 6 % for spheres, cones and flat punches (Johnson, Contact Mechanics, sections 3.3, 4.2, 5.2; derivation and
/// figures in docs/theory.md). delta is the approach of what lies far from the zone, while the cells already deform as
/// under a force spread over the whole group: the approach in that is subtracted, delta = -gap + C F, with C the mean
/// displacement of a half-space's square (0.946 / (E* h)) and of its neighbours (1 / (pi E* r)).
#pragma once

#include <array>
#include <vector>

#include "contact/groups/gap_samples.hpp"
#include "contact/kernels/group_kernels.hpp"
#include "contact/model/contact_pairs.hpp"
#include "recovery/face/symmetry_planes.hpp"

namespace cgcontact {

/// Spring of a group in (or beside) a small zone: [stress - stiffness gap]_+ at every point. No points: its mean gap
/// presses.
struct ZoneSpring {
  double stiffness = 0;                       ///< Pa/m
  std::vector<std::array<double, 2>> points;  ///< weight, m^2, and stress, Pa
};

/// Forces of a pair that prescribed motions, interferences or overlaps give: none (loads do: it is left alone), that
/// between two bodies held by supports, that on a body which is squeezed between others.
enum class DisplacementDriven { no, held, squeezed };

class SmallZones {
 public:
  /// The arguments must outlive this object.
  SmallZones(const std::vector<BodyModel>& bodies, std::vector<ContactPair>& pairs, std::vector<DisplacementDriven> led,
             const SolverOptions& options);

  /// Empties the small zones.
  void forget();

  /// Computes new forces from the present state, of all groups of all pairs in order: change of the mean gap, m, and
  /// forces of groups outside of small zones, N. Sets the active points of small zones. decide: groups join or leave.
  void update(const std::vector<double>& gap_change, const std::vector<double>& group_force, bool decide);

  bool has(std::size_t group) const { return groups_[group].small; }
  /// Returns the force by the mean gap (m, with interference and deformation): linear about the last update.
  ZoneForce force(std::size_t group) const {
    const State& g = groups_[group];
    return {g.force, g.stiffness, g.gap};
  }
  /// Returns the spring of a group while rigid motions change its gap, in pairs of squeezed bodies: as force() says, or
  /// by its samples where the zone carries nothing yet.
  ZoneSpring spring(std::size_t group) const;
  /// Counts the groups of a pair that are in small zones and carry force.
  int count(int pair) const;
  struct Width {
    double width = 0, cell = 0;  ///< m; size of the cell that transmits most
    double force = 0;            ///< N, of all
  };
  /// Returns the mean width of a pair's small zones, by their forces; 0 without any.
  Width width(int pair) const;
  /// Returns the change of the forces in the last update, relative to all of small zones.
  double relative_change() const { return relative_change_; }

 private:
  struct State {
    bool small = false, beside = false;        ///< beside: nothing overlaps yet, but may when bodies move
    double force = 0, stiffness = 0, gap = 0;  ///< N, N/m, m: what force() is made of
    double bedding = 0;                        ///< Pa/m: force over volume, kept once groups no longer join
    double width = 0;                          ///< m, of the zone there
    double limit = 0;                          ///< m: the depth that the samples are made for
    std::vector<GapSample> samples;
  };
  struct Zone {
    std::vector<std::size_t> groups;  ///< among those of all pairs
  };
  struct Overlap;
  struct Law;
  struct Neighbours;

  void decide_pair(std::size_t pair, const std::vector<double>& gap_change, const std::vector<double>& group_force);
  std::vector<char> near_resolved(std::size_t pair) const;
  void sample(std::size_t pair, std::size_t group, double overlap);
  std::vector<Zone> zones(std::size_t pair, const std::vector<std::size_t>& groups) const;
  Neighbours neighbours(std::size_t pair, const Zone& zone) const;
  Law evaluate(std::size_t pair, const Zone& zone, const std::vector<double>& gap_change,
               const std::vector<double>& forces, bool decide) const;
  double approach(std::size_t pair, std::size_t g, const std::vector<double>& gap_change,
                  const std::vector<double>& group_force) const;
  double effective_modulus(std::size_t pair) const;
  const ContactGroup& group(std::size_t pair, std::size_t g) const { return pairs_[pair].groups[g - first_[pair]]; }
  double deepest_squeeze(const std::vector<double>& gap_change, const std::vector<double>& group_force) const;
  void set_active_points(std::size_t pair, std::size_t g, double change, double extra);

  const std::vector<BodyModel>& bodies_;
  std::vector<ContactPair>& pairs_;
  std::vector<DisplacementDriven> led_;
  const SolverOptions& options_;
  std::vector<std::vector<SymmetryPlane>> planes_;  ///< of each pair
  std::vector<std::size_t> first_;                  ///< of each pair's groups
  std::vector<State> groups_;
  double relative_change_ = 0;
  double squeeze_ = 0;  ///< m: so much deeper than their present gap squeezed bodies may come
};

}  // namespace cgcontact
