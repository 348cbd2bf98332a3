#include "recovery/spr.hpp"

namespace cgcontact {

int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const IntView& nodes, const CellStressView& stress,
                const CoefficientView& coefficients) {
  const auto begin = patches.begin_view;
  const auto cells = patches.cells_view;
  const auto mass = patches.mass;
  const auto centre = patches.cell_centre;
  const auto position = patches.node_position;
  const bool all = nodes.extent(0) == 0;
  const int count = all ? mesh.num_nodes : static_cast<int>(nodes.extent(0));
  int singular = 0;
  Kokkos::parallel_reduce(
      "cgcontact::spr::fit_patches", Kokkos::RangePolicy<ExecSpace>(0, count),
      KOKKOS_LAMBDA(const int index, int& failed) {
        const int n = all ? index : nodes(index);
        const auto offset = [&](int c, double d[3]) {
          for (int i = 0; i < 3; ++i) d[i] = centre(c, i) - position(n, i);
        };
        double m[num_terms][num_terms], H[6][num_terms];
        gather_patch(cells, begin(n), begin(n + 1), offset, mass, stress, m, H);
        const double volume = m[0][0];
        const bool regular = cholesky(m);
        if (!regular) ++failed;
        for (int k = 0; k < 6; ++k) {
          if (regular) {
            cholesky_solve(m, H[k]);
          } else {
            H[k][0] /= volume;
            H[k][1] = H[k][2] = H[k][3] = 0;
          }
          for (int t = 0; t < num_terms; ++t) coefficients(n, k, t) = H[k][t];
        }
      },
      singular);
  return singular;
}

}  // namespace cgcontact
