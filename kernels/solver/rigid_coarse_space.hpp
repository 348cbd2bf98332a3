/// Rigid motions of bodies that no support holds, and those of rigid bodies, solved for exactly beside the
/// preconditioner. Coarse grids see the contact that holds such a body only roughly: where neighbouring groups have
/// become one row, a ball may turn freely, and the coarse solution turns it thousands of times too far (a ball between
/// three walls: eigenvalues of up to 4,800, 67 iterations instead of 8). So coarse grids hold these bodies firmly
/// (SupportTerm::soft), and the motions follow from the finest grid.
///
/// With R the motions and M the preconditioner, z = M r + R E^-1 R^T (r - A M r), E = R^T A R ("A-DEF2" of J. M. Tang,
/// R. Nabben, C. Vuik, Y. A. Erlangga, J. Sci. Comput. 39, 2009), from a start with R^T r = 0. A R is not stored:
/// bodies do not deform in R, so only the rows of supports and contact groups enter.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "kernels/ranks/rank_share.hpp"

namespace cgcontact {

class RigidCoarseSpace {
 public:
  using Forces = Kokkos::View<const double*, MemSpace>;
  /// The whole system, which must outlive this. exec: what kernels run on.
  RigidCoarseSpace(const ExecSpace& exec, const ElasticSystem& system);
  /// Sets what this rank has of the system, whose vectors correct() takes from now on.
  void set_share(const RankShare& share);

  /// Takes over the present stiffness of the contact groups; not if empty.
  void update();
  bool empty() const { return num_motions_ == 0; }

  /// z += R E^-1 R^T (r - A z). r, z: num_dofs entries. Collective with a share.
  void correct(const Forces& r, const RealView& z) const;

 private:
  /// Free motions of one body: columns (translation, rotation about the centre times its size), grid axes.
  struct Body {
    int mesh = 0;
    Vec3 centre = Vec3::Zero();  ///< cells
    double size = 1;             ///< cells: radius of gyration
    Eigen::Matrix<double, 6, Eigen::Dynamic> motions;
    int first = 0;  ///< column of R
  };
  /// k (row . u)^2 / 2 of a support point or contact group, with the row's product with R.
  struct Row {
    std::vector<std::pair<int, double>> entries;     ///< (DoF, coefficient)
    std::vector<std::pair<int, double>> on_motions;  ///< (column of R, row . column)
    double stiffness = 0;
  };

  Body free_motions(int mesh) const;
  Row make_row(std::vector<std::pair<int, double>> entries, double stiffness) const;
  /// Leaves those that this rank has; all without a share.
  void keep_own_entries(Row& row) const;
  /// Returns this rank's mesh of the body.
  const BodyMesh& mesh_of(const Body& body) const { return (share_ ? share_->system() : system_).meshes[body.mesh]; }
  Eigen::VectorXd sums(const Forces& r) const;  ///< R^T r, of this rank
  void add(const Eigen::VectorXd& amounts, const RealView& x) const;

  ExecSpace exec_;
  const ElasticSystem& system_;
  const RankShare* share_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<int> body_of_mesh_;  ///< index into bodies_, -1: its supports hold it
  int num_motions_ = 0;
  std::vector<Row> supports_, groups_;  ///< those that resist a motion; groups_: as in the system
  Eigen::LDLT<Eigen::MatrixXd> energy_;
};

}  // namespace cgcontact
