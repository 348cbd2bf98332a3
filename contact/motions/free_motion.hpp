/// Rigid motions that neither supports nor closed contact resist. Frictionless contact resists nothing along its faces,
/// so bodies often slide or spin freely: driven by loads there is no solution, else they can be held.
#pragma once

#include <string>

#include "contact/motions/rigid_motion.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {

struct FreeMotions {
  std::vector<RigidComponent> bodies;
  Eigen::MatrixXd modes;  ///< orthonormal columns; rows 6 b .. 6 b + 5: RigidMotion of body b

  /// Joins the motions of the same bodies.
  void add(const FreeMotions& other);
  /// Keeps what support points do not resist.
  void leave_out(const std::vector<SupportPoint>& supports, const std::vector<BodyModel>& models);
  bool empty() const { return modes.cols() == 0; }
  /// Returns whether there is a motion without any rotation.
  bool slides() const;
  /// Returns those without any rotation.
  FreeMotions without_rotation() const;
};

/// Fraction of all loads below which no motion is driven. They are integrated to 1e-9.
constexpr double no_load = 1e-7;

/// Finds free motions at the present state of the contact points: those resisted by less than `no_stiffness` of the
/// most resisted.
FreeMotions find_free_motions(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                              const std::vector<ContactPair>& pairs, double no_stiffness = rounding);

/// Resistance of a body against its rigid motions: sum of w q q^T.
using Resistance = Eigen::Matrix<double, 6, 6>;

/// Returns columns that span the motions of a body that a resistance does not resist.
Eigen::MatrixXd motions_not_resisted(const Resistance& resistance);

/// Adds the resistance of a support point to its body and to those that are bonded to it (bonded_assemblies).
void add_resistance(const SupportPoint& point, const std::vector<RigidComponent>& components,
                    const std::vector<BodyModel>& bodies, const std::vector<int>& assembly,
                    std::vector<Resistance>& held);

/// Finds motions of one body (with those bonded to it) that leave its own contact surface unchanged (`own`: a ball in
/// its seat), or that of all others (`others`: a ball on plates): free as well, although closed points with the normals
/// of the other side seem to resist them.
struct SurfaceMotions {
  FreeMotions own, others;
};
SurfaceMotions find_surface_motions(const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                                    const std::vector<ContactPair>& pairs);

/// Returns those of `free` (of points with the normals of the primary body) that no point resists with the normals of
/// the secondary body either.
FreeMotions free_on_both_sides(const FreeMotions& free, const std::vector<BodyModel>& bodies,
                               const std::vector<ContactPair>& pairs);

/// Returns for each body, or assembly of bonded bodies, the motions that its own supports leave free.
std::vector<FreeMotions> motions_of_floating_bodies(const std::vector<BodyModel>& bodies,
                                                    const std::vector<SupportPoint>& supports,
                                                    const std::vector<ContactPair>& pairs);

/// Returns the work of the loads on the motions of all bodies (rows as in FreeMotions::modes), N, and the sum of the
/// forces' magnitudes.
std::pair<Eigen::VectorXd, double> loads_on(const std::vector<BodyModel>& bodies,
                                            const std::vector<RigidComponent>& components);

/// Returns those with more work of the loads than the fraction `allowed` of them: one column, or
/// none.
FreeMotions driven_by_loads(const FreeMotions& free, const std::vector<BodyModel>& bodies, double allowed = no_load);

/// Returns "y" for a direction along an axis, else three components.
std::string direction_text(Vec3 direction);

/// Returns "body "ball" is free to move along (1.000, 0.000, 0.000) and to rotate about all axes"; of the body that
/// moves most.
std::string describe(const FreeMotions& free, const Scene& scene);

/// Returns as many held points as there are free motions, none of them redundant: they carry no force unless loads
/// drive the motions. Their `support` is -1.
std::vector<SupportPoint> hold(const FreeMotions& free, const std::vector<BodyModel>& bodies);

}  // namespace cgcontact
