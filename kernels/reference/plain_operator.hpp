/// The reference twin of the fast operator: element matrices and plain kernels.
#pragma once

#include "kernels/reference/apply.hpp"

namespace cgcontact {

class PlainOperator {
 public:
  /// The system must outlive the operator.
  explicit PlainOperator(const ElasticSystem& system) : system_(system) {
    for (std::size_t b = 0; b < system.meshes.size(); ++b) {
      meshes_.push_back(colour_mesh(system.meshes[b]));
      matrices_.push_back(make_cell_matrices(system.meshes[b], system.supports[b]));
      ghosts_.push_back(make_ghost_matrix(system.meshes[b], system.ghost_penalty));
    }
  }

  /// y = A x, with the present stiffness of the contact groups.
  template <class Exec, class X, class Y>
  void apply(const Exec& exec, const X& x, const Y& y) const {
    Kokkos::deep_copy(exec, y, 0.0);
    for (std::size_t b = 0; b < system_.meshes.size(); ++b) {
      apply_cells(exec, meshes_[b], matrices_[b], x, y);
      apply_ghost_faces(exec, meshes_[b], ghosts_[b], x, y);
    }
    apply_groups(exec, system_.groups, x, y);
  }

 private:
  const ElasticSystem& system_;
  std::vector<ColouredMesh> meshes_;
  std::vector<CellMatrixView> matrices_;
  std::vector<GhostMatrix> ghosts_;
};

}  // namespace cgcontact
