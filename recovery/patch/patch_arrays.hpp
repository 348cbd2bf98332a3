/// Patches as kernels for any Kokkos execution space see them, and their mass matrices.
#pragma once

#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/patches.hpp"
#include "recovery/patch/subset.hpp"

namespace cgcontact {

/// Some of a body's cells or nodes (Subset), in some memory.
template <class Memory>
struct SubsetArrays {
  Kokkos::View<const int*, Memory> numbers, rows;  ///< empty: all
  int size = 0;

  KOKKOS_FORCEINLINE_FUNCTION int number(int row) const { return numbers.extent(0) == 0 ? row : numbers(row); }
  KOKKOS_FORCEINLINE_FUNCTION int row(int number) const { return rows.extent(0) == 0 ? number : rows(number); }
};

/// Arrays of one body that these kernels read, in some memory.
template <class Memory>
struct PatchArrays {
  template <class T>
  using Array = Kokkos::View<T, Kokkos::LayoutRight, Memory>;
  Array<const int* [8]> cell_nodes;   ///< node numbers of all bodies
  Array<const int*[3]> cells, nodes;  ///< positions in the grid
  Array<const int*> cut_of_cell;
  Array<const double* [17]> moments;  ///< PatchSet::moments
  Array<const int*> begin, patch_cells;
  Array<const char*> full;
  Array<const int*> factor_of_patch;
  Array<const double* [10]> factors;      ///< PatchSet::factors
  Array<const signed char*> levels;       ///< of the cells; empty: 0
  Array<const signed char*> node_levels;  ///< of the nodes; empty: 0
  UnitElasticity law;
  double coarse_stress_factor = 1;  ///< on level 0
  int flat = -1, radial = -1;       ///< of bodies of revolution the axes across, where all lies at 0, and away from it
  double axis_offset = 0;           ///< distance of the grid's origin from the axis of revolution, cells of level 0

  bool KOKKOS_FORCEINLINE_FUNCTION has_levels() const { return levels.extent(0) != 0; }
  /// Returns the level whose cells are the unit of a node's polynomial.
  KOKKOS_FORCEINLINE_FUNCTION int level_of(int node) const { return has_levels() ? node_levels(node) : 0; }
  /// Returns the size of a cell in units of those of a level.
  KOKKOS_FORCEINLINE_FUNCTION double size_of(int cell, int level) const {
    if (!has_levels()) return 1;
    const int finer = levels(cell) - level;
    return finer >= 0 ? 1.0 / (1 << finer) : 1 << -finer;
  }

  /// Returns the distance from a node's patch to the centre of a cell, in cells of the size `size`.
  KOKKOS_FORCEINLINE_FUNCTION double offset(int axis, int cell, double size, const double centre[3]) const {
    return axis == flat ? 0 : size * (cells(cell, axis) + 0.5) - centre[axis];
  }
  /// Returns BodyMesh::ring_of.
  KOKKOS_FORCEINLINE_FUNCTION Ring ring_of(int cell) const {
    if (flat < 0) return {};
    const double finer = has_levels() ? 1 << levels(cell) : 1;
    return {flat, radial, 2 * (cells(cell, radial) + 0.5 + finer * axis_offset)};
  }

  /// Returns BodyMesh::stress_factor.
  KOKKOS_FORCEINLINE_FUNCTION double stress_factor(int cell) const {
    return levels.extent(0) == 0 ? coarse_stress_factor : coarse_stress_factor * (1 << levels(cell));
  }
};

/// Views the arrays of a vector as rows on the host; the values of one as a view.
template <class View, class T>
View rows_of(const std::vector<T>& rows) {
  return View(rows.empty() ? nullptr : rows.front().data(), rows.size());
}
template <class View, class T>
View view_of(const std::vector<T>& values) {
  return View(values.data(), values.size());
}

/// Return those on the host: the arrays of the mesh and the patches themselves.
SubsetArrays<Kokkos::HostSpace> host_arrays(const Subset& subset);
PatchArrays<Kokkos::HostSpace> host_arrays(const BodyMesh& mesh, const PatchSet& patches);

/// Copies in another memory, unless that is the host's.
template <class Memory>
PatchArrays<Memory> arrays_in(const PatchArrays<Kokkos::HostSpace>& host) {
  const auto copy = [](const auto& view) { return Kokkos::create_mirror_view_and_copy(Memory(), view); };
  return {
      copy(host.cell_nodes), copy(host.cells),       copy(host.nodes), copy(host.cut_of_cell),     copy(host.moments),
      copy(host.begin),      copy(host.patch_cells), copy(host.full),  copy(host.factor_of_patch), copy(host.factors),
      copy(host.levels),     copy(host.node_levels), host.law,         host.coarse_stress_factor,  host.flat,
      host.radial,           host.axis_offset};
}
template <class Memory>
SubsetArrays<Memory> arrays_in(const SubsetArrays<Kokkos::HostSpace>& host) {
  return {Kokkos::create_mirror_view_and_copy(Memory(), host.numbers),
          Kokkos::create_mirror_view_and_copy(Memory(), host.rows), host.size};
}

/// Mass matrix m of some cells about a centre, lengths in cells of a level: mean over the cells' own volumes.
template <class Memory>
KOKKOS_INLINE_FUNCTION void gather_mass(const PatchArrays<Memory>& body, const int* cells, int num_cells,
                                        const double centre[3], double m[num_terms][num_terms], int level = 0) {
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) m[i][j] = 0;
  for (int c = 0; c < num_cells; ++c) {
    const double* mass = &body.moments(1 + body.cut_of_cell(cells[c]), 0);
    const double size = body.size_of(cells[c], level);
    double scaled[10];
    if (size != 1) {
      for (int q = 0; q < 10; ++q) scaled[q] = mass[q] * (q == 0 ? 1 : q < 4 ? size : size * size);
      mass = scaled;
    }
    double d[3];  // centre of the cell relative to the patch's
    for (int i = 0; i < 3; ++i) d[i] = body.offset(i, cells[c], size, centre);
    const double v = mass[0], first[3] = {mass[1], mass[2], mass[3]};
    const double second[3][3] = {{mass[4], mass[7], mass[9]}, {mass[7], mass[5], mass[8]}, {mass[9], mass[8], mass[6]}};
    m[0][0] += v;
    for (int i = 0; i < 3; ++i) {
      m[0][1 + i] += first[i] + v * d[i];
      for (int j = 0; j < 3; ++j) m[1 + i][1 + j] += second[i][j] + d[i] * first[j] + d[j] * first[i] + v * d[i] * d[j];
    }
  }
  for (int i = 0; i < 3; ++i) m[1 + i][0] = m[0][1 + i];
}

/// Factorises a 4 x 4 mass matrix in place (Cholesky, lower); false if it is not positive definite.
KOKKOS_INLINE_FUNCTION bool cholesky(double m[num_terms][num_terms]) {
  for (int j = 0; j < num_terms; ++j) {
    double diagonal = m[j][j];
    for (int k = 0; k < j; ++k) diagonal -= m[j][k] * m[j][k];
    if (!(diagonal > 1e-14 * m[j][j])) return false;
    m[j][j] = sqrt(diagonal);
    for (int i = j + 1; i < num_terms; ++i) {
      double sum = m[i][j];
      for (int k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      m[i][j] = sum / m[j][j];
    }
  }
  return true;
}

/// Solves L L^T a = b in place.
KOKKOS_INLINE_FUNCTION void cholesky_solve(const double L[num_terms][num_terms], double b[num_terms]) {
  for (int i = 0; i < num_terms; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
    b[i] /= L[i][i];
  }
  for (int i = num_terms - 1; i >= 0; --i) {
    for (int k = i + 1; k < num_terms; ++k) b[i] -= L[k][i] * b[k];
    b[i] /= L[i][i];
  }
}

}  // namespace cgcontact
