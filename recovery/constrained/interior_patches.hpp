/// The closed form of the constrained fit of interior patches: eight full cells without contact, where only equilibrium
/// is known (paper, equation 4). For any Kokkos execution space.
#pragma once

#include "recovery/spr/spr_kernels.hpp"

namespace cgcontact {

/// Marks the nodes of interior patches among some in `interior` (row of the subset) and corrects their linear
/// polynomials `values` (row, component, term). in_contact: cells that hold points of a contact face. divergence: what
/// div sigma must be at the nodes, per cell unit (row, 3); empty: zero.
template <class Exec, class Memory, class CellMarks, class Divergence, class Values, class NodeMarks>
void correct_interior(const Exec& exec, const PatchArrays<Memory>& body, const SubsetArrays<Memory>& nodes,
                      const CellMarks& in_contact, const Divergence& divergence, const Values& values,
                      const NodeMarks& interior) {
  Kokkos::parallel_for(
      "cgcontact::interior_patches::correct", Kokkos::RangePolicy<Exec>(exec, 0, nodes.size),
      KOKKOS_LAMBDA(const int row) {
        const int n = nodes.number(row);
        interior(row) = body.full(n);
        for (int p = body.begin(n); interior(row) && p < body.begin(n + 1); ++p)
          if (in_contact(body.patch_cells(p))) interior(row) = 0;
        if (!interior(row)) return;
        double value[3];
        for (int i = 0; i < 3; ++i) value[i] = divergence.extent(0) == 0 ? 0.0 : divergence(row, i);
        put_in_equilibrium(value, &values(row, 0, 0));
      });
}

}  // namespace cgcontact
