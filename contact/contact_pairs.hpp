/// Contact pairs: quadrature points on the coarser body's surface, their opposite points, groups of projected gaps.
#pragma once

#include <optional>

#include "contact/model.hpp"
#include "recovery/subset.hpp"

namespace cgcontact {

/// Point of another body's boundary met along a normal.
struct OppositePoint {
  double distance;  ///< m, along the ray (negative: the bodies overlap there)
  int cell;         ///< active cell of the other body
  Vec3 position;    ///< grid coordinates of the other body
};

/// First boundary point of `other` (face `face`) along x + t n, |t| <= search, whose outward normal opposes n;
/// the nearest one if there are several.
std::optional<OppositePoint> find_opposite(const BodyModel& other, const FaceSpec& face, const Vec3& x, const Vec3& n,
                                           double search);

/// A quadrature point of a pair, on the coarser body ("primary"), split at both grids.
struct ContactPoint {
  int group = 0;
  int primary_cell = 0, secondary_cell = 0;
  Vec3 primary_xi, secondary_xi;              ///< cell coordinates
  Vec3 primary_position, secondary_position;  ///< grid coordinates
  Vec3 normal;                                ///< outward of the primary body, global axes
  Vec3 x;                                     ///< m
  double weight = 0;                          ///< m^2
  double distance = 0;                        ///< m, before deformation, along the normal
  bool active = true;
};

/// Points of one cell and surface of the primary body: the gap is projected on one constant per group (design section
/// 4).
struct ContactGroup {
  int first_point = 0, last_point = 0;
  int surface = 0;         ///< of the primary body
  double area = 0;         ///< m^2
  double initial_gap = 0;  ///< m, mean distance minus interference
};

struct ContactPair {
  const ContactSpec* spec = nullptr;
  int primary = 0, secondary = 0;  ///< bodies; the primary has the larger cells
  double stiffness = 0;            ///< kappa E/h: harmonic mean of both moduli over the smaller cell size, Pa/m
  double search = 0;               ///< m
  std::vector<ContactPoint> points;
  std::vector<ContactGroup> groups;
  const FaceSpec& face(int body) const { return spec->first.body == body ? spec->first.face : spec->second.face; }
};

/// Pairs of the scene; also marks the bodies' boundary points that have an opposite surface.
/// Throws InputError if a named pair has no point in reach or the bodies overlap by more than half a cell.
std::vector<ContactPair> make_contact_pairs(const Scene& scene, std::vector<BodyModel>& bodies);

/// Nodes of a body's cells within a few cells of its contact faces.
Subset nodes_near_contact(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies, int body,
                          const BodyMesh& mesh);

/// Rows of the mean gap change of all groups of all pairs, in order; dimensionless (displacement per displacement).
std::vector<GroupRow> make_group_rows(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies,
                                      const ElasticSystem& system);

/// Hands the contact points with their state to the bodies' boundary data, for the recovery.
/// group_force: N, compression positive, of all groups of all pairs in order; empty: not known.
void update_contact_links(const std::vector<ContactPair>& pairs, std::vector<BodyModel>& bodies,
                          const std::vector<double>& group_force = {});

}  // namespace cgcontact
