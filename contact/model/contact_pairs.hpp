/// Contact pairs: quadrature points on the coarser body's surface, their opposite points, groups of projected gaps.
#pragma once

#include "contact/kernels/contact_law.hpp"
#include "contact/kernels/contact_points.hpp"
#include "contact/model/opposite_points.hpp"
#include "recovery/patch/subset.hpp"

namespace cgcontact {

/// Points of one surface of the primary body in one cell, the larger one of the two that meet there: the gap is
/// projected on one constant per group (docs/theory.md).
struct ContactGroup {
  int first_point = 0, last_point = 0;
  int surface = 0;                   ///< of the primary body
  int body = 0, cell = 0;            ///< the larger cell: the primary body's, or the secondary's where these are larger
  double larger_cell = 0;            ///< m, its size
  double area = 0;                   ///< m^2
  double h = 0;                      ///< m, smallest of the cells of both bodies that its points lie in
  double distance = 0;               ///< m, mean of its points
  double initial_gap = 0;            ///< m, distance minus interference
  Vec3 tangent_axis = Vec3::Zero();  ///< friction: tangents of its points come from this and their normals
};

struct ContactPair;
/// Return the mean of a contact group's points, m; the least distance of one from the other body before deformation, m;
/// whether one is closed.
Vec3 centre_of(const ContactPair& pair, const ContactGroup& group);
double nearest_distance(const ContactPair& pair, const ContactGroup& group);
bool is_closed(const ContactPair& pair, const ContactGroup& group);

struct ContactPair {
  const ContactSpec* spec = nullptr;
  int primary = 0, secondary = 0;  ///< bodies; the primary has the largest cells at the face
  double modulus = 0;              ///< kappa E: of the harmonic mean of both stabilising moduli, Pa
  Reach reach;
  double largest_cell = 0;  ///< m, at the faces; where a point sees nothing opposite, a cell is at most that
  double interference = 0;  ///< m, in the present step
  /// Bonded pairs have all points, and all groups, once for every axis that they hold: one copy after the other.
  ContactPoints points;
  std::vector<ContactGroup> groups;
  int copies = 1;
  /// Return the points and groups of one copy: those of the surface.
  std::size_t num_surface_points() const { return points.size() / copies; }
  std::size_t num_surface_groups() const { return groups.size() / copies; }
  bool bonded() const { return spec->bonded; }
  /// Returns Coulomb's coefficient; 0: no friction.
  double friction() const { return spec->friction; }
  /// Directions along the faces in which friction acts: none without it, one in plane strain, else two.
  int num_tangents = 0;
  /// Returns those at a point, unit, orthogonal to its normal and to each other, global axes; the first `num_tangents`
  /// count.
  std::array<Vec3, 2> tangents(std::size_t point) const;
  /// Calls use(tangent) for those that count at a point: none without friction.
  template <class Use>
  void each_tangent(std::size_t point, const Use& use) const {
    if (num_tangents == 0) return;
    const std::array<Vec3, 2> along = tangents(point);
    for (int i = 0; i < num_tangents; ++i) use(along[i]);
  }
  /// Calls use(direction) for the directions in which a closed point holds: its own, and with friction the tangents.
  template <class Use>
  void each_direction(std::size_t point, const Use& use) const {
    use(points.direction(point));
    each_tangent(point, use);
  }
  double stiffness(const ContactGroup& group) const { return modulus / group.h; }  ///< kappa E/h, Pa/m
  NormalContact law(const ContactGroup& group) const { return {stiffness(group), bonded()}; }
  int other(int body) const { return primary == body ? secondary : primary; }
  const FaceSpec& face(int body) const { return spec->first.body == body ? spec->first.face : spec->second.face; }
};

/// Friction at the points of a pair after a load step, global axes; empty without friction.
struct FrictionPoints {
  std::vector<Vec3> shear;        ///< Pa, on the secondary body
  std::vector<Vec3> slip;         ///< m, of the secondary body against the primary one since the points last met
  std::vector<double> travelled;  ///< m, lengths of the slips of all steps
  std::vector<double> wear;       ///< Pa m, pressure times slip of all steps (Archard, J. Appl. Phys. 24 (1953) 981)
  std::vector<double> bound;      ///< Pa, the most that friction carried at the end of the last step
  std::vector<char> slips;        ///< closed, and no longer where it was at the end of the last step
  double work = 0;                ///< J, dissipated in all steps
};

/// Finds the point of the other body that a boundary point of a pair sees; in automatic pairs third bodies block the
/// view.
std::optional<OppositePoint> find_opposite(const std::vector<BodyModel>& bodies, const ContactPair& pair, int body,
                                           const Vec3& x, const Vec3& n);

/// Makes the pairs of the scene, in its order, without automatic ones out of reach; marks the bodies' boundary points
/// with an opposite surface. `wider`: least view of each contact of the scene, m (empty: 0). Throws InputError if a
/// named pair has no point in reach, or bodies overlap by more than contact can take.
std::vector<ContactPair> make_contact_pairs(const Scene& scene, std::vector<BodyModel>& bodies,
                                            const std::vector<double>& wider = {});

/// Sets the interference of a pair, m, and with it the initial gaps; bonded faces have none.
void set_interference(ContactPair& pair, double interference);

/// Returns the nodes of a body's cells within a few cells of its contact faces.
Subset nodes_near_contact(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies, int body,
                          const BodyMesh& mesh);

/// Sums the forces of a bonded pair on its secondary body at one group of the surface over all axes that it holds, N.
Vec3 force_of_surface_group(const ContactPair& pair, const double* group_force, std::size_t group);

/// Warnings of bonded faces that are apart, or overlap, where they are tied.
std::vector<std::string> bonded_gap_warnings(const Scene& scene, const std::vector<ContactPair>& pairs);

/// Hands the contact points with their state to the bodies' boundary data, for the recovery.
/// group_force: N, compression positive, of all groups of all pairs in order; empty: not known. friction: of each pair;
/// empty: none.
void update_contact_links(const std::vector<ContactPair>& pairs, std::vector<BodyModel>& bodies,
                          const std::vector<double>& group_force = {},
                          const std::vector<FrictionPoints>& friction = {});

}  // namespace cgcontact
