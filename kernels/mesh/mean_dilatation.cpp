#include "kernels/mesh/mean_dilatation.hpp"

#include "kernels/mesh/interpolate.hpp"

namespace cgcontact {

double mean_dilatation(const BodyMesh& mesh, int cell, const double u[8][3]) {
  if (!(mesh.law.lambda_of_mean > 0)) return 0;
  using Gauss = Gauss3;  // dilatation times radius: of degree 2 in each coordinate
  constexpr int n = Gauss::count;
  const CutCells& cc = *mesh.cut_cells;
  const Ring ring = mesh.ring_of(cell);
  const int cut = cc.cut_of_active[cell];
  double weights[n * n * n], sum = 0, volume = 0;
  fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights);
  for (int q = 0; q < n * n * n; ++q) {
    const double xi[3] = {Gauss::point[q / (n * n)], Gauss::point[q / n % n], Gauss::point[q % n]};
    double g[3][3];
    interpolate_gradient(u, xi, g);
    add_ring_strain(ring, u, xi, g);
    const double w = weights[q] * (ring.across < 0 ? 1 : ring.diameter + xi[ring.radial]);
    sum += w * (g[0][0] + g[1][1] + g[2][2]);
    volume += w;
  }
  return sum / volume;
}

}  // namespace cgcontact
