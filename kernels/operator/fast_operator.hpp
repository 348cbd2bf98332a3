/// The matrix-free operator at full speed: y = A x of all bodies, in double or in float (multigrid).
///   stencil_tiles.hpp  nodes whose cells are all active: the factorised 27-point stencil
///   band_cells.hpp     cut cells and full cells on flat faces, supports
///   ghost_chains.hpp     ghost penalty
/// and the contact groups as sparse rows. apply.hpp is the plain reference.
///
/// One thread of a 2-core Zen 4 (bench_operator), million unknowns per second, double / float:
///   cube of 46 cells, no cell cut    490 / 800        ball of 46 cells, 18 % cut    244 / 380
///   cube of 118 (5M unknowns)        340 / 600        ball of 118, 7 % cut          223 / 400
/// The ball of 46 takes 750 us: stencil 280, cut cells 330 (38 ns each), ghost penalty 160.
#pragma once

#include "kernels/operator/band_cells.hpp"
#include "kernels/operator/ghost_chains.hpp"
#include "kernels/operator/stencil_tiles.hpp"

namespace cgcontact {

template <class Real>
class FastOperator {
 public:
  using VectorView = Kokkos::View<Real*, MemSpace>;
  using ConstVectorView = Kokkos::View<const Real*, MemSpace>;
  using BlockView = Kokkos::View<Real* [6], Kokkos::LayoutRight, MemSpace>;

  /// Sizes of the operator, for cost models.
  struct Sizes {
    long long num_nodes = 0, stencil_nodes = 0, cut_cells = 0, full_cells = 0, supported_cells = 0, ghost_faces = 0,
              ghost_chains = 0, groups = 0, group_entries = 0;
    std::size_t bytes = 0;
  };

  /// Reads meshes, supports, ghost penalty and groups; keeps nothing of the system.
  explicit FastOperator(const ElasticSystem& system);

  int num_dofs() const { return dof_of(num_nodes_); }
  const Sizes& sizes() const { return sizes_; }

  /// Takes over rows and stiffnesses; their coupling in double only: preconditioners are symmetric.
  void set_groups(const ElasticSystem& system);

  /// y = A x. x is consistent, b, y and r are zero at constrained nodes (DofMap).
  void apply(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const;
  /// r = b - A x. r may be b.
  void residual(const ExecSpace& exec, const ConstVectorView& b, const ConstVectorView& x, const VectorView& r) const;

  /// Terms of y = A x: the first assigns (zero at nodes outside of the stencil), the others add.
  void apply_stencil(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const;
  void add_band(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y, bool cells, bool ghosts) const;
  void add_groups(const ExecSpace& exec, const ConstVectorView& x, const VectorView& y) const;

  /// Computes the symmetric 3x3 block of each node (xx, yy, zz, xy, yz, zx) of everything but the contact groups.
  /// Masters also have the blocks of the nodes that they constrain times the square of the weights (without coupling of
  /// two of those nodes: enough for smoothing; in plane strain there is none), constrained nodes and those of other
  /// ranks the identity.
  void diagonal_blocks(const ExecSpace& exec, const BlockView& blocks) const;
  /// The same, and the blocks between different nodes of a column (into zero matrices).
  void diagonal_blocks(const ExecSpace& exec, const BlockView& blocks, const NodeColumns<Real>& columns) const;

 private:
  template <bool subtract>
  void stencil(const ExecSpace& exec, const Real* x, const Real* base, Real* y) const;
  template <bool subtract>
  void band(const ExecSpace& exec, const Real* x, Real* y, bool cells, bool ghosts) const;
  void groups(const ExecSpace& exec, const Real* x, Real* y, Real sign) const;

  void gather_constrained_blocks(const ExecSpace& exec, const BlockView& blocks) const;

  struct Groups {
    IntView row_begin, row_dof, dof_begin, dof_list, column_group, coupled_row;
    VectorView row_value, column_value, stiffness, coupling, scratch;

    KOKKOS_INLINE_FUNCTION Real gap(int g, const Real* x) const {
      Real sum = 0;
      for (int e = row_begin(g); e < row_begin(g + 1); ++e) sum += row_value(e) * x[row_dof(e)];
      return sum;
    }
  };

  int num_nodes_ = 0;
  DofMap dofs_;
  StencilTiles<Real> tiles_;
  BandCells<Real> cells_;
  GhostChains<Real> ghosts_;
  Groups groups_;
  std::shared_ptr<const RowSums> group_sums_;
  Kokkos::View<int* [2], Kokkos::LayoutRight, MemSpace> other_nodes_;  ///< (range, first and length): not by stencil
  IntView slabs_[2];                                                   ///< of each colour
  Kokkos::View<Real*, MemSpace> stencil_diagonal_;                     ///< per body
  Kokkos::View<Real* [3][3], Kokkos::LayoutRight, MemSpace> stencil_next_;  ///< (body, axis, component)
  IntView body_first_node_;
  Kokkos::View<char*, MemSpace> by_stencil_;
  Kokkos::View<Real**, Kokkos::LayoutRight, MemSpace> rings_;  ///< per thread
  Sizes sizes_;
};

}  // namespace cgcontact
