/// The closed form of the constrained fit of interior patches: eight full cells without contact, where only equilibrium
/// is known (paper, equation 4). For any Kokkos execution space.
#pragma once

#include "recovery/spr/spr_kernels.hpp"

namespace cgcontact {

/// Marks the interior patches of a body in `interior` (node) and corrects their linear polynomials `values` (node,
/// component, term). in_contact: cells that hold points of a contact face. divergence: what div sigma must be at the
/// nodes, per cell unit (node, 3); empty: zero.
///
/// The mass matrix of a full patch is diagonal and the same for all slopes: each row of the equilibrium is corrected on
/// its own, its three terms alike.
template <class Exec, class Memory, class CellMarks, class Divergence, class Values, class NodeMarks>
void correct_interior(const Exec& exec, const PatchArrays<Memory>& body, const CellMarks& in_contact,
                      const Divergence& divergence, const Values& values, const NodeMarks& interior) {
  Kokkos::parallel_for(
      "cgcontact::interior_patches::correct", Kokkos::RangePolicy<Exec>(exec, 0, body.full.extent(0)),
      KOKKOS_LAMBDA(const int n) {
        constexpr int term[3][3] = {{1, 14, 23}, {13, 6, 19}, {21, 18, 11}};  // slope along j of component (i, j)
        interior(n) = body.full(n);
        for (int p = body.begin(n); interior(n) && p < body.begin(n + 1); ++p)
          if (in_contact(body.patch_cells(p))) interior(n) = 0;
        if (!interior(n)) return;
        double* a = &values(n, 0, 0);
        for (int i = 0; i < 3; ++i) {
          const int* t = term[i];
          const double value = divergence.extent(0) == 0 ? 0.0 : divergence(n, i);
          const double correction = (value - (a[t[0]] + a[t[1]] + a[t[2]])) / 3;
          for (int j = 0; j < 3; ++j) a[t[j]] += correction;
        }
      });
}

}  // namespace cgcontact
