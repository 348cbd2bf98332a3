/// Rigid motions of bodies, or of their connected components, and which of them supports and closed contact resist.
#pragma once

#include <vector>

#include "contact/model/contact_pairs.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {

/// Translation t, then rotation r: u(x) = t + r x (x - centre) / size.
using RigidMotion = Eigen::Matrix<double, 6, 1>;

/// A body or a connected component of one.
struct RigidComponent {
  int body = 0;
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);  ///< box around its cells, m
  Vec3 centre() const { return 0.5 * (low + high); }
  double size() const { return (high - low).maxCoeff(); }
  /// Returns the row q with q . motion = u(x) . d.
  RigidMotion row(const Vec3& x, const Vec3& d) const {
    RigidMotion q;
    q << d, ((x - centre()) / size()).cross(d);
    return q;
  }
};

struct RigidComponents {
  std::vector<RigidComponent> list;
  std::vector<std::vector<int>> of_cell;  ///< body, active cell -> index into list; empty: one component per body
  int at(int body, int cell) const { return of_cell.empty() ? body : of_cell[body][cell]; }
};

/// Returns one per body, in their order.
RigidComponents whole_bodies(const std::vector<BodyModel>& bodies);
/// Finds the connected components of bodies.
RigidComponents components_of(const std::vector<BodyModel>& bodies);

/// Returns for each body its assembly, made by bonded faces: the smallest index of the bodies in it.
std::vector<int> bonded_assemblies(std::size_t num_bodies, const std::vector<ContactPair>& pairs);

/// Returns a basis (orthonormal columns; rows 6 k .. 6 k + 5: motion of component k) of the motions that are resisted
/// by less than `no_stiffness` of what is resisted most among the components that contact joins; with the present state
/// of the contact points.
Eigen::MatrixXd free_rigid_motions(const RigidComponents& components, const std::vector<BodyModel>& bodies,
                                   const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                                   double no_stiffness = rounding);

}  // namespace cgcontact
