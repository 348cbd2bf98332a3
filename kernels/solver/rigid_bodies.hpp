/// Bodies that move as a whole: of their nodes' values only rigid motions count. With Q an orthonormal basis of the
/// rigid motions of a body's free nodes, and P = Q Q^T on its nodes, the identity on all others, the system is P A P:
/// six unknowns for the body, whose own stiffness does not enter (K Q = 0).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/operator/operator.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

/// The two kinds of vectors (DofMap): forces are zero at constrained nodes, displacements consistent.
enum class NodeValues { forces, displacements };

class RigidBodies {
 public:
  /// The system must outlive this. exec: what kernels run on.
  RigidBodies(const ExecSpace& exec, const ElasticSystem& system);
  bool empty() const { return bodies_.empty(); }
  /// Projects v to P v, of all bodies.
  void project(NodeValues kind, const RealView& v) const;

 private:
  struct Body {
    const BodyMesh* mesh;
    Vec3 centre;                                 ///< cells
    Eigen::Matrix<double, 6, 6> motion_of_sums;  ///< from the sums of the free nodes' values to the motion
    Kokkos::View<char*, MemSpace> is_free;       ///< by node
  };
  void project(const Body& body, NodeValues kind, const RealView& v) const;

  ExecSpace exec_;
  std::vector<Body> bodies_;
};

/// An operator whose argument is projected already, with its result projected: the system, or a preconditioner.
class OnRigidMotions : public TpetraOperator {
 public:
  /// `bodies` must outlive this.
  OnRigidMotions(Teuchos::RCP<const TpetraOperator> inner, const RigidBodies& bodies, NodeValues result)
      : inner_(std::move(inner)), bodies_(bodies), result_(result) {}

  Teuchos::RCP<const TpetraMap> getDomainMap() const override { return inner_->getDomainMap(); }
  Teuchos::RCP<const TpetraMap> getRangeMap() const override { return inner_->getRangeMap(); }
  /// alpha = 1, beta = 0 only.
  void apply(const TpetraVector& X, TpetraVector& Y, Teuchos::ETransp mode, double alpha, double beta) const override;

 private:
  Teuchos::RCP<const TpetraOperator> inner_;
  const RigidBodies& bodies_;
  NodeValues result_;
};

}  // namespace cgcontact
