/// Kernels of plain SPR for any Kokkos execution space: integrals over cells, fits of patches (paper, equation 1).
#pragma once

#include "recovery/patch/patch_arrays.hpp"
#include "recovery/spr/corner_differences.hpp"

namespace cgcontact {

/// Integrals of {1, x, y, z} sigma_h over one cell from its corner displacements (grid axes, u[corner][axis]; become
/// sums and differences) and its moments. `factor`: BodyMesh::stress_factor().
KOKKOS_INLINE_FUNCTION void cell_stress_integrals(const UnitElasticity& law, double factor, double u[8][3],
                                                  const double moments[17], double out[6][num_terms],
                                                  const Ring& ring = {}) {
  corner_differences(u);
  // Moments of the four terms of each derivative times {1, x, y, z}.
  constexpr int slot[3][num_terms][4] = {{{0, 2, 3, 8}, {1, 7, 9, 10}, {2, 5, 8, 14}, {3, 8, 6, 16}},
                                         {{0, 1, 3, 9}, {1, 4, 9, 12}, {2, 7, 8, 10}, {3, 9, 6, 15}},
                                         {{0, 1, 2, 7}, {1, 4, 7, 11}, {2, 7, 5, 13}, {3, 9, 8, 10}}};
  double gradient[num_terms][3][3], dilatation[num_terms];
  for (int t = 0; t < num_terms; ++t) {
    double(&g)[3][3] = gradient[t];
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        g[i][j] = 0;
        for (int term = 0; term < 4; ++term)
          g[i][j] += corner_scale(term) * moments[slot[j][t][term]] * u[corner_difference(j, term)][i];
      }
    if (ring.across >= 0) {
      const int a = ring.across;
      double c[4];
      ring_differences(ring, u, c);
      g[a][a] = g[ring.radial][ring.radial];
      for (int term = 0; term < 4; ++term) g[a][a] += c[term] * moments[slot[a][t][term]];
    }
    dilatation[t] = g[0][0] + g[1][1] + g[2][2];
  }
  // Over a volume that is in proportion to the radius.
  const int r = 1 + ring.radial;
  const double mean = ring.across < 0 ? dilatation[0] / moments[0]
                                      : (ring.diameter * dilatation[0] + 2 * dilatation[r]) /
                                            (ring.diameter * moments[0] + 2 * moments[r]);
  for (int t = 0; t < num_terms; ++t) {
    double s[6];
    law.stress(gradient[t], mean * moments[t], s);
    for (int k = 0; k < 6; ++k) out[k][t] = factor * s[k];
  }
}

/// Integrates the stress of a full cell, whose only moments up to degree 3 that are not zero are its volume and 1/12 of
/// the squares: each coordinate meets the term of the derivative that is linear in it.
KOKKOS_INLINE_FUNCTION void full_cell_stress_integrals(const UnitElasticity& law, double factor, double u[8][3],
                                                       double out[6][num_terms]) {
  corner_differences(u);
  for (int t = 0; t < num_terms; ++t) {
    double g[3][3] = {}, s[6];
    for (int j = 0; j < 3; ++j) {
      if (t == 1 + j) continue;
      const int term = t == 0 ? 0 : t - 1 < j ? t : t - 1;  // of the other two coordinates
      const double weight = corner_scale(term) * (t == 0 ? 1 : 1. / 12);
      for (int i = 0; i < 3; ++i) g[i][j] = weight * u[corner_difference(j, term)][i];
    }
    law.stress(g, t == 0 ? g[0][0] + g[1][1] + g[2][2] : 0, s);
    for (int k = 0; k < 6; ++k) out[k][t] = factor * s[k];
  }
}

/// Integrates one row of `out` for each of the cells. u: displacements of all bodies, three per node.
template <class Exec, class Memory, class Displacements, class Stress>
void integrate_cells(const Exec& exec, const PatchArrays<Memory>& body, const SubsetArrays<Memory>& cells,
                     const Displacements& u, const Stress& out) {
  using Policy = Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
  Kokkos::parallel_for(
      "cgcontact::spr::cell_integrals", Policy(exec, 0, cells.size, Kokkos::ChunkSize(256)),
      KOKKOS_LAMBDA(const int row) {
        const int cell = cells.number(row), cut = body.cut_of_cell(cell);
        double corner[8][3], integrals[6][num_terms];
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i) corner[a][i] = u(dof_of(body.cell_nodes(cell, a), i));
        if (cut < 0)
          full_cell_stress_integrals(body.law, body.stress_factor(cell), corner, integrals);
        else
          cell_stress_integrals(body.law, body.stress_factor(cell), corner, &body.moments(1 + cut, 0), integrals,
                                body.ring_of(cell));
        for (int k = 0; k < 6; ++k)
          for (int t = 0; t < num_terms; ++t) out(row, k, t) = integrals[k][t];
      });
}

/// Gathers the right-hand side H of a patch, shifted to its centre, lengths in cells of a level; row r of `stress`
/// belongs to cell stressed.number(r).
template <class Memory, class Stress>
KOKKOS_INLINE_FUNCTION void gather_stress(const PatchArrays<Memory>& body, const int* cells, int num_cells,
                                          const double centre[3], const Stress& stress,
                                          const SubsetArrays<Memory>& stressed, double H[6][num_terms], int level = 0) {
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) H[k][t] = 0;
  for (int c = 0; c < num_cells; ++c) {
    const double* s = &stress(stressed.row(cells[c]), 0, 0);
    const double size = body.size_of(cells[c], level);
    double scaled[6 * num_terms], shift[num_terms] = {};
    if (size != 1) {
      for (int k = 0; k < 6 * num_terms; ++k) scaled[k] = s[k] * (k % num_terms == 0 ? 1 : size);
      s = scaled;
    }
    for (int i = 0; i < 3; ++i) shift[1 + i] = body.offset(i, cells[c], size, centre);
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) H[k][t] += s[num_terms * k + t] + shift[t] * s[num_terms * k];
  }
}

/// Fits eight full cells around a node: the mass matrix is diag(8, 8/3, 8/3, 8/3). The cells are ascending, so that the
/// bits of their index are their offsets. integrals(c): the 6 x 4 ones of the c-th cell.
template <class Integrals>
KOKKOS_INLINE_FUNCTION void fit_full_patch(const Integrals& integrals, double* a) {
  double H[6][num_terms] = {};
  for (int c = 0; c < 8; ++c) {
    const double* s = integrals(c);
    const double d[num_terms] = {0, (c & 1) - 0.5, (c >> 1 & 1) - 0.5, (c >> 2) - 0.5};
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) H[k][t] += s[num_terms * k + t] + d[t] * s[num_terms * k];
  }
  const double inverse[num_terms] = {1. / 8, 3. / 8, 3. / 8, 3. / 8};
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) a[num_terms * k + t] = inverse[t] * H[k][t];
}

/// Puts an interior patch in equilibrium: the sums of slopes that make up div sigma become `divergence` (per cell
/// unit). The mass matrix of a full patch is diagonal and the same for all slopes: each row is corrected on its own,
/// its three terms alike (paper, equation 4).
KOKKOS_INLINE_FUNCTION void put_in_equilibrium(const double divergence[3], double* a) {
  constexpr int term[3][3] = {{1, 14, 23}, {13, 6, 19}, {21, 18, 11}};  // slope along j of component (i, j)
  for (int i = 0; i < 3; ++i) {
    const int* t = term[i];
    const double correction = (divergence[i] - (a[t[0]] + a[t[1]] + a[t[2]])) / 3;
    for (int j = 0; j < 3; ++j) a[t[j]] += correction;
  }
}

/// Integrals of the cells of a patch in the rows of a subset.
template <class Memory, class Stress>
struct PatchIntegrals {
  const int* cells;
  const Stress& stress;
  const SubsetArrays<Memory>& stressed;
  KOKKOS_INLINE_FUNCTION const double* operator()(int c) const { return &stress(stressed.row(cells[c]), 0, 0); }
};

/// Fits the nodes of a subset; one row of `values` for each. Returns the number of singular patches.
template <class Exec, class Memory, class Stress, class Values>
int fit_nodes(const Exec& exec, const PatchArrays<Memory>& body, const SubsetArrays<Memory>& nodes,
              const Stress& stress, const SubsetArrays<Memory>& stressed, const Values& values) {
  using Policy = Kokkos::RangePolicy<Exec, Kokkos::Schedule<Kokkos::Dynamic>>;
  int singular = 0;
  Kokkos::parallel_reduce(
      "cgcontact::spr::fit", Policy(exec, 0, nodes.size, Kokkos::ChunkSize(512)),
      KOKKOS_LAMBDA(const int row, int& sum) {
        const int n = nodes.number(row), begin = body.begin(n);
        const int* cells = &body.patch_cells(begin);
        double* a = &values(row, 0, 0);
        if (body.full(n)) {
          fit_full_patch(PatchIntegrals<Memory, Stress>{cells, stress, stressed}, a);
          return;
        }
        if (body.factor_of_patch(n) < 0) return;  // a constrained node
        const double centre[3] = {double(body.nodes(n, 0)), double(body.nodes(n, 1)), double(body.nodes(n, 2))};
        double H[6][num_terms], L[num_terms][num_terms];
        gather_stress(body, cells, body.begin(n + 1) - begin, centre, stress, stressed, H, body.level_of(n));
        const double* factor = &body.factors(body.factor_of_patch(n), 0);
        const bool regular = factor[0] > 0;
        for (int i = 0, entry = 0; i < num_terms; ++i)
          for (int j = 0; j <= i; ++j) L[i][j] = factor[entry++];
        for (int k = 0; k < 6; ++k) {
          if (regular) {
            cholesky_solve(L, H[k]);
          } else {  // the mean stress
            H[k][0] /= -factor[0];
            H[k][1] = H[k][2] = H[k][3] = 0;
          }
          for (int t = 0; t < num_terms; ++t) a[num_terms * k + t] = H[k][t];
        }
        sum += !regular;
      },
      singular);
  return singular;
}

}  // namespace cgcontact
