/// Reference of the fast operator: element matrices and plain kernels, for elements of degree 1 or 2. Degree 1 works on
/// the system's own nodes; degree 2 has nodes of its own (nodes(level)), and no contact groups yet, whose rows are
/// those of trilinear nodes.
#pragma once

#include <stdexcept>

#include "kernels/reference/apply.hpp"

namespace cgcontact {

template <int degree = 1>
class PlainOperator {
 public:
  /// The system must outlive the operator.
  explicit PlainOperator(const ElasticSystem& system) : system_(system) {
    if (degree != 1 && !system.group_rows.empty())
      throw std::logic_error("plain operator: contact groups are rows of trilinear elements");
    int num_nodes = 0;
    if (degree != 1 && !system.constraints.empty())
      throw std::logic_error("plain operator: nodes are constrained for trilinear elements only");
    const std::vector<const BodyMesh*> levels = system.level_meshes();
    for (std::size_t p = 0; p < levels.size(); ++p) {
      nodes_.push_back(number_element_nodes<degree>(*levels[p]->cut_cells, num_nodes, virtual_cells(*levels[p])));
      num_nodes += static_cast<int>(nodes_.back().positions.size());
      meshes_.push_back(colour_mesh<degree>(*levels[p], nodes_.back().of_cell));
      matrices_.push_back(make_cell_matrices<degree>(*levels[p], system.supports[p]));
      ghosts_.push_back(make_ghost_matrix<degree>(*levels[p], system.ghost_penalty));
    }
    dofs_ = DofMap(num_nodes, system.constraints, system.zero_dofs);
  }

  const DofMap& dofs() const { return dofs_; }
  const ElementNodes<degree>& nodes(std::size_t level) const { return nodes_[level]; }

  /// y = A x, with the present stiffness of the contact groups. x is consistent, y is zero at constrained nodes.
  template <class Exec, class X, class Y>
  void apply(const Exec& exec, const X& x, const Y& y) const {
    Kokkos::deep_copy(exec, y, 0.0);
    for (std::size_t p = 0; p < meshes_.size(); ++p) {
      apply_cells<degree>(exec, meshes_[p], matrices_[p], x, y);
      apply_ghost_faces<degree>(exec, meshes_[p], ghosts_[p], x, y);
    }
    apply_groups(exec, system_.groups, x, y);
    apply_constraints_transposed(exec, dofs_, y);
  }

 private:
  const ElasticSystem& system_;
  DofMap dofs_;
  std::vector<ElementNodes<degree>> nodes_;
  std::vector<ColouredMeshOf<degree>> meshes_;
  std::vector<CellMatrixViewOf<degree>> matrices_;
  std::vector<GhostMatrixOf<degree>> ghosts_;
};

}  // namespace cgcontact
