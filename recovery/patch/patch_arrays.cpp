#include "recovery/patch/patch_arrays.hpp"

namespace cgcontact {

SubsetArrays<Kokkos::HostSpace> host_arrays(const Subset& subset) {
  using Numbers = Kokkos::View<const int*, Kokkos::HostSpace>;
  return {view_of<Numbers>(subset.numbers()), view_of<Numbers>(subset.rows()), subset.size()};
}

PatchArrays<Kokkos::HostSpace> host_arrays(const BodyMesh& mesh, const PatchSet& patches) {
  using Arrays = PatchArrays<Kokkos::HostSpace>;
  const CutCells& cc = *mesh.cut_cells;
  return {rows_of<decltype(Arrays::cell_nodes)>(mesh.cell_nodes),
          rows_of<decltype(Arrays::cells)>(cc.cells),
          rows_of<decltype(Arrays::nodes)>(mesh.nodes),
          view_of<decltype(Arrays::cut_of_cell)>(cc.cut_of_active),
          rows_of<decltype(Arrays::moments)>(patches.moments),
          view_of<decltype(Arrays::begin)>(patches.begin),
          view_of<decltype(Arrays::patch_cells)>(patches.cells),
          view_of<decltype(Arrays::full)>(patches.full),
          view_of<decltype(Arrays::factor_of_patch)>(patches.factor_of_patch),
          rows_of<decltype(Arrays::factors)>(patches.factors),
          view_of<decltype(Arrays::levels)>(cc.levels),
          view_of<decltype(Arrays::node_levels)>(mesh.node_levels),
          mesh.law,
          mesh.modulus / mesh.h_of_level(0),
          mesh.is_axisymmetric() ? cc.grid.plane_strain : -1,
          mesh.is_axisymmetric() ? cc.grid.radial_axis() : -1,
          cc.grid.radius(Vec3::Zero()) / cc.grid.cell_size};
}

}  // namespace cgcontact
