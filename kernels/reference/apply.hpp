/// Kernels of the reference operator, matrix-free and plain: cells, ghost faces, contact groups. x and y are vectors of
/// DofMap::num_dofs entries; every kernel adds to y. Colours keep the writes apart, so the result does not depend on
/// the number of threads.
#pragma once

#include "kernels/operator/element_matrices.hpp"
#include "kernels/operator/system.hpp"
#include "kernels/reference/coloured_mesh.hpp"

namespace cgcontact {

/// y += sum_cells K_cell x_cell. Degree 1: 1152 flop per cell; 24 + 24 (+ 4.6 kB matrix of a cut cell) bytes x 8.
template <int degree = 1, class Exec, class X, class Y>
void apply_cells(const Exec& exec, const ColouredMeshOf<degree>& mesh, const CellMatrixViewOf<degree>& matrices,
                 const X& x, const Y& y) {
  constexpr int num_nodes = HexElement<degree>::num_nodes, num_dofs = HexElement<degree>::num_dofs;
  const auto nodes = mesh.nodes_of_cell;
  const auto matrix_of_cell = mesh.matrix_of_cell;
  for (std::size_t colour = 0; colour + 1 < mesh.colour_begin.size(); ++colour) {
    Kokkos::parallel_for(
        "cgcontact::apply::cells",
        Kokkos::RangePolicy<Exec>(exec, mesh.colour_begin[colour], mesh.colour_begin[colour + 1]),
        KOKKOS_LAMBDA(const int cell) {
          double u[num_dofs], v[num_dofs];
          for (int a = 0; a < num_nodes; ++a)
            for (int i = 0; i < 3; ++i) {
              u[dof_of(a, i)] = x(dof_of(nodes(cell, a), i));
              v[dof_of(a, i)] = 0;
            }
          const int m = matrix_of_cell(cell);
          for (int c = 0; c < num_dofs; ++c)
            for (int r = 0; r < num_dofs; ++r) v[r] += matrices(m, c, r) * u[c];  // symmetric: row c is column c
          for (int a = 0; a < num_nodes; ++a)
            for (int i = 0; i < 3; ++i) y(dof_of(nodes(cell, a), i)) += v[dof_of(a, i)];
        });
  }
}

/// y += sum_faces (G x I_3) x_face. Degree 1: 864 flop per face.
template <int degree = 1, class Exec, class X, class Y>
void apply_ghost_faces(const Exec& exec, const ColouredMeshOf<degree>& mesh, const GhostMatrixOf<degree>& ghost,
                       const X& x, const Y& y) {
  constexpr int num_nodes = GhostFace<degree>::num_nodes;
  const auto nodes = mesh.nodes_of_face;
  const auto ring = mesh.ring_of_face;
  for (std::size_t colour = 0; colour + 1 < mesh.face_colour_begin.size(); ++colour) {
    Kokkos::parallel_for(
        "cgcontact::apply::ghost_faces",
        Kokkos::RangePolicy<Exec>(exec, mesh.face_colour_begin[colour], mesh.face_colour_begin[colour + 1]),
        KOKKOS_LAMBDA(const int face) {
          double v[num_nodes][3] = {};
          for (int b = 0; b < num_nodes; ++b)
            for (int i = 0; i < 3; ++i) {
              const double u = ring(face) * x(dof_of(nodes(face, b), i));
              for (int a = 0; a < num_nodes; ++a) v[a][i] += ghost[a][b] * u;
            }
          for (int a = 0; a < num_nodes; ++a)
            for (int i = 0; i < 3; ++i) y(dof_of(nodes(face, a), i)) += v[a][i];
        });
  }
}

/// y += B^T (diag(k) + C) B x, C the coupling: gather per group, then gather per touched DoF (no atomics).
template <class Exec, class X, class Y>
void apply_groups(const Exec& exec, const GroupRows& rows, const X& x, const Y& y) {
  const int num_groups = static_cast<int>(rows.stiffness.extent(0));
  if (num_groups == 0) return;
  const GroupRows r = rows;
  Kokkos::parallel_for(
      "cgcontact::apply::group_gaps", Kokkos::RangePolicy<Exec>(exec, 0, num_groups), KOKKOS_LAMBDA(const int g) {
        double gap = 0;
        for (int e = r.row_begin(g); e < r.row_begin(g + 1); ++e) gap += r.row_value(e) * x(r.row_dof(e));
        r.scratch(g) = r.stiffness(g) * gap;
        if (r.coupling.extent(0) == 0 || r.coupled_row(g) < 0) return;
        const int other = r.coupled_row(g);
        for (int e = r.row_begin(other); e < r.row_begin(other + 1); ++e)
          r.scratch(g) += r.coupling(g) * r.row_value(e) * x(r.row_dof(e));
      });
  const int num_dofs = static_cast<int>(r.dof_list.extent(0));
  Kokkos::parallel_for(
      "cgcontact::apply::group_forces", Kokkos::RangePolicy<Exec>(exec, 0, num_dofs), KOKKOS_LAMBDA(const int d) {
        double force = 0;
        for (int e = r.dof_begin(d); e < r.dof_begin(d + 1); ++e)
          force += r.column_value(e) * r.scratch(r.column_group(e));
        y(r.dof_list(d)) += force;
      });
}

}  // namespace cgcontact
