/// Stiffness matrices of the cells. Sizes are cells along the edge of a block on a grid that does not fit it.
#include <cmath>
#include <memory>

#include "kernels/operator/element_matrices.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// Per cell: weights 0.5 kflop; per Gauss point 120 for the gradients of the 8 shape functions and, for each of the
/// 8 x 8 pairs of nodes, 5 + 9 x 7 + 3 x 3 flop; symmetrising 3 per entry. Bytes: 125 moments read, 576 entries
/// written.
constexpr double flop_per_cell = 500 + 27 * (120 + 64 * (5 + 9 * 7 + 3 * 3)) + 3 * 576;
constexpr double bytes_per_cell = 8.0 * (num_moments + 2 * 576);

/// Largest relative error of the energy of a linear displacement: E(u) = volume * sigma : grad u in every cell.
double energy_error(const BlockProblem& p, const CellMatrixView& matrices) {
  const double g[3][3] = {{0.7, -0.2, 0.4}, {0.3, -0.5, 0.1}, {-0.6, 0.25, 0.9}};
  double s[6];
  const BodyMesh& mesh = p.system.meshes[0];
  mesh.law.stress(g, 0, s);
  const double density = s[0] * g[0][0] + s[1] * g[1][1] + s[2] * g[2][2] + s[3] * (g[0][1] + g[1][0]) +
                         s[4] * (g[1][2] + g[2][1]) + s[5] * (g[2][0] + g[0][2]);
  double u[24];
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) u[dof_of(a, i)] = g[i][0] * (a & 1) + g[i][1] * (a >> 1 & 1) + g[i][2] * (a >> 2);
  double largest = 0;
  for (std::size_t m = 0; m < matrices.extent(0); ++m) {
    double energy = 0;
    for (int r = 0; r < 24; ++r)
      for (int c = 0; c < 24; ++c) energy += u[r] * matrices(m, r, c) * u[c];
    const double volume = m == 0 ? 1 : p.cut_cells.moments[m - 1][0] / 8;
    largest = std::max(largest, std::abs(energy - density * volume) / density);
  }
  return largest;
}

Kernel cell_matrices(int size) {
  auto p = std::make_shared<BlockProblem>(size);
  const BodyMesh& mesh = p->system.meshes[0];
  Kernel k;
  k.unit = "cells";
  k.items = 1.0 + static_cast<double>(p->cut_cells.moments.size());
  k.cost = {k.items * flop_per_cell, k.items * bytes_per_cell};
  k.error = energy_error(*p, make_cell_matrices(mesh, {})), k.tolerance = 1e-12, k.against = "energy of a linear field";
  k.run = [p] { make_cell_matrices(p->system.meshes[0], {}); };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] { add("elements/cut", cell_matrices, {{4}, {24}}); });
}
