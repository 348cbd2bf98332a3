/// Integrals over the cells of a patch about one centre, for any Kokkos execution space.
#pragma once

#include "recovery/patch/patch_arrays.hpp"
#include "recovery/spr/cell_stress.hpp"

namespace cgcontact {

/// Integrals of one body (StressIntegrals) as kernels see them, in some memory.
template <class Memory>
struct IntegralArrays {
  template <class T>
  using Array = Kokkos::View<T, Kokkos::LayoutRight, Memory>;
  SubsetArrays<Memory> subset;
  Array<const double * [CellSums::num_stress * CellSums::num_components]> stress;  ///< row; term, component
  Array<const double*> square;                                                     ///< row
  Array<const double* [num_quartics]> moments;
  Array<const int*> moments_of_row;
  Array<const int* [3]> cells;       ///< of the body: positions in the grid
  Array<const signed char*> levels;  ///< of the cells; empty: 0
  int flat = -1;                     ///< of bodies of revolution the axis across: all cells and centres lie at 0

  KOKKOS_FORCEINLINE_FUNCTION bool hold(int cell) const { return subset.row(cell) >= 0; }
  KOKKOS_FORCEINLINE_FUNCTION int level(int cell) const { return levels.extent(0) == 0 ? 0 : levels(cell); }
  /// Returns the volume of the material in a cell that they hold.
  KOKKOS_FORCEINLINE_FUNCTION double volume(int cell) const { return moments(moments_of_row(subset.row(cell)), 0); }

  KOKKOS_FORCEINLINE_FUNCTION double offset(int axis, int index, const double centre[3]) const {
    return axis == flat ? 0 : index + 0.5 - centre[axis];
  }

  /// Sums over ascending cells of one level; the level is the unit of the centre and the sums.
  KOKKOS_INLINE_FUNCTION CellSums sum_of_level(const int* list, int num, const double centre[3]) const {
    CellSums total{};
    for (int i = 0; i < num;) {
      const int z = cells(list[i], 2);
      CellSums layer{};
      while (i < num && cells(list[i], 2) == z) {
        const int y = cells(list[i], 1);
        CellSums line{};
        for (; i < num && cells(list[i], 1) == y && cells(list[i], 2) == z; ++i) {
          const int row = subset.row(list[i]);
          line.add<0>(&stress(row, 0), &moments(moments_of_row(row), 0), square(row),
                      offset(0, cells(list[i], 0), centre));
        }
        layer.add<1>(line, offset(1, y, centre));
      }
      total.add<2>(layer, offset(2, z, centre));
    }
    return total;
  }

  /// Sums over ascending cells, about a centre; centre and unit of lengths: grid coordinates. The cells count alike,
  /// whatever their size. The integrals over all of them are known.
  KOKKOS_INLINE_FUNCTION CellSums sum(const int* list, int num, const double centre[3], double unit) const {
    if (levels.extent(0) == 0) return sum_of_level(list, num, centre);
    CellSums total{};
    for (int first = 0; first < num;) {
      const int of_level = levels(list[first]);
      const double per_unit = 1 << of_level;
      int end = first + 1;
      while (end < num && levels(list[end]) == of_level) ++end;
      const double centre_of_level[3] = {centre[0] * per_unit, centre[1] * per_unit, centre[2] * per_unit};
      total.add_scaled(sum_of_level(list + first, end - first, centre_of_level), 1 / (per_unit * unit));
      first = end;
    }
    return total;
  }
};

/// Returns those on the host: the arrays of the integrals and the mesh themselves.
IntegralArrays<Kokkos::HostSpace> host_arrays(const BodyMesh& mesh, const StressIntegrals& integrals);

}  // namespace cgcontact
