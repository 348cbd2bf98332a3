#include "recovery/spr/spr.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "recovery/patch/polynomials.hpp"
#include "recovery/spr/corner_differences.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 512;

/// Fit of eight full cells around a node: the mass matrix is diag(8, 8/3, 8/3, 8/3). The cells are ascending, so that
/// the bits of their place are their offsets.
void fit_full_patch(const int* cells, const CellStressView& stress, const Subset& stressed, double* a) {
  double H[6][num_terms] = {};
  for (int c = 0; c < 8; ++c) {
    const double* s = &stress(stressed.row(cells[c]), 0, 0);
    const double d[num_terms] = {0, (c & 1) - 0.5, (c >> 1 & 1) - 0.5, (c >> 2) - 0.5};
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) H[k][t] += s[num_terms * k + t] + d[t] * s[num_terms * k];
  }
  const double inverse[num_terms] = {1. / 8, 3. / 8, 3. / 8, 3. / 8};
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) a[num_terms * k + t] = inverse[t] * H[k][t];
}

/// False if the mass matrix is singular.
bool fit_patch(PatchSums& sums, double* a) {
  const double volume = sums.m[0][0];
  const bool regular = cholesky(sums.m);
  for (int k = 0; k < 6; ++k) {
    double* H = sums.H[k];
    if (regular) {
      cholesky_solve(sums.m, H);
    } else {
      H[0] /= volume;
      H[1] = H[2] = H[3] = 0;
    }
    for (int t = 0; t < num_terms; ++t) a[num_terms * k + t] = H[t];
  }
  return regular;
}

}  // namespace

RecoveredField part_of(const RecoveredField& field, Subset nodes) {
  RecoveredField part{std::move(nodes), {}};
  part.values =
      CoefficientView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::spr::part"), part.nodes.size());
  for (int row = 0; row < part.nodes.size(); ++row)
    std::copy_n(field.at(part.nodes.number(row)), 6 * num_terms, &part.values(row, 0, 0));
  return part;
}

void add_edge_terms(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3], const double N[8],
                    double s[6]) {
  const Vec3 x = grid_position(*mesh.cut_cells, cell, Vec3(xi[0], xi[1], xi[2]));
  for (int a = 0; a < 8; ++a) {
    const EdgeTerms::Term* term = field.edge->of_node(mesh.cell_nodes[cell][a] - mesh.first_node);
    if (!term) continue;
    double w[6];
    term->edge.stress(x, w);
    for (int k = 0; k < 6; ++k) s[k] += N[a] * term->factor * w[k];
  }
}

void add_quadratic_terms(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3],
                         const double N[8], double s[6]) {
  for (int a = 0; a < 8; ++a) {
    const QuadraticTerms::Values* values = field.quadratic->of_node(mesh.cell_nodes[cell][a] - mesh.first_node);
    if (!values) continue;
    const double d[3] = {0.5 * (xi[0] + 1) - (a & 1), 0.5 * (xi[1] + 1) - (a >> 1 & 1), 0.5 * (xi[2] + 1) - (a >> 2)};
    double p[Polynomial<2>::num_terms];
    Polynomial<2>::terms(d, p);
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < QuadraticTerms::count; ++t) s[k] += N[a] * p[num_terms + t] * (*values)[k][t];
  }
}

void cell_stress_integrals(const UnitElasticity& law, double factor, const double u[8][3],
                           const MonomialMoments& moments, double out[6][num_terms]) {
  double h[8][3];
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) h[a][i] = u[a][i];
  corner_differences(h);
  // Moments of the four terms of each derivative times {1, x, y, z}.
  constexpr int place[3][num_terms][4] = {{{0, 2, 3, 8}, {1, 7, 9, 10}, {2, 5, 8, 14}, {3, 8, 6, 16}},
                                          {{0, 1, 3, 9}, {1, 4, 9, 12}, {2, 7, 8, 10}, {3, 9, 6, 15}},
                                          {{0, 1, 2, 7}, {1, 4, 7, 11}, {2, 7, 5, 13}, {3, 9, 8, 10}}};
  for (int t = 0; t < num_terms; ++t) {
    double g[3][3], s[6];
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        g[i][j] = 0;
        for (int term = 0; term < 4; ++term)
          g[i][j] += corner_scale[term] * moments[place[j][t][term]] * h[corner_difference[j][term]][i];
      }
    law.stress(g, s);
    for (int k = 0; k < 6; ++k) out[k][t] = factor * s[k];
  }
}

namespace {

/// Of a full cell, whose only moments up to degree 3 that are not zero are its volume and 1/12 of the squares: each
/// coordinate meets the term of the derivative that is linear in it.
void full_cell_stress_integrals(const UnitElasticity& law, double factor, const double u[8][3],
                                double out[6][num_terms]) {
  double h[8][3];
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) h[a][i] = u[a][i];
  corner_differences(h);
  for (int t = 0; t < num_terms; ++t) {
    double g[3][3] = {}, s[6];
    for (int j = 0; j < 3; ++j) {
      if (t == 1 + j) continue;
      const int term = t == 0 ? 0 : t - 1 < j ? t : t - 1;  // of the other two coordinates
      const double weight = corner_scale[term] * (t == 0 ? 1 : 1. / 12);
      for (int i = 0; i < 3; ++i) g[i][j] = weight * h[corner_difference[j][term]][i];
    }
    law.stress(g, s);
    for (int k = 0; k < 6; ++k) out[k][t] = factor * s[k];
  }
}

}  // namespace

void integrate_cell_stress(const BodyMesh& mesh, const PatchSet& patches, const Subset& cells, const RealView& u,
                           const CellStressView& out) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
  parallel_for("cgcontact::spr::cell_integrals", cells.size(), grain, [&](std::size_t row) {
    const int cell = cells.number(static_cast<int>(row));
    double corner[8][3];
    corner_values(mesh.cell_nodes[cell], host, corner);
    double integrals[6][num_terms];
    if (mesh.cut_cells->cut_of_active[cell] < 0)
      full_cell_stress_integrals(mesh.law, mesh.stress_factor(cell), corner, integrals);
    else
      cell_stress_integrals(mesh.law, mesh.stress_factor(cell), corner, patches.moments_of(*mesh.cut_cells, cell),
                            integrals);
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) out(row, k, t) = integrals[k][t];
  });
}

Subset cells_of_patches(const BodyMesh& mesh, const PatchSet& patches, const Subset& nodes) {
  std::vector<char> marked(mesh.cell_nodes.size(), 0);
  for (int row = 0; row < nodes.size(); ++row) {
    const int n = nodes.number(row);
    for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p) marked[patches.cells[p]] = 1;
  }
  return Subset(marked);
}

void gather_mass(const BodyMesh& mesh, const PatchSet& patches, const int* cells, int num_cells, const double centre[3],
                 double m[num_terms][num_terms]) {
  const CutCells& cc = *mesh.cut_cells;
  std::fill(&m[0][0], &m[0][0] + num_terms * num_terms, 0.0);
  for (int c = 0; c < num_cells; ++c) {
    const MonomialMoments& mass = patches.moments_of(cc, cells[c]);
    double d[3];  // centre of the cell relative to the patch's
    for (int i = 0; i < 3; ++i) d[i] = cc.cells[cells[c]][i] + 0.5 - centre[i];
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

PatchSums gather_patch(const BodyMesh& mesh, const PatchSet& patches, const int* cells, int num_cells,
                       const double centre[3], const CellStressView& stress, const Subset& stressed) {
  PatchSums sums = {};
  gather_mass(mesh, patches, cells, num_cells, centre, sums.m);
  for (int c = 0; c < num_cells; ++c) {
    const Index3& cell = mesh.cut_cells->cells[cells[c]];
    const double* s = &stress(stressed.row(cells[c]), 0, 0);
    const double shift[num_terms] = {0, cell[0] + 0.5 - centre[0], cell[1] + 0.5 - centre[1],
                                     cell[2] + 0.5 - centre[2]};
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) sums.H[k][t] += s[num_terms * k + t] + shift[t] * s[num_terms * k];
  }
  return sums;
}

bool cholesky(double m[num_terms][num_terms]) {
  for (int j = 0; j < num_terms; ++j) {
    double diagonal = m[j][j];
    for (int k = 0; k < j; ++k) diagonal -= m[j][k] * m[j][k];
    if (!(diagonal > 1e-14 * m[j][j])) return false;
    m[j][j] = std::sqrt(diagonal);
    for (int i = j + 1; i < num_terms; ++i) {
      double sum = m[i][j];
      for (int k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      m[i][j] = sum / m[j][j];
    }
  }
  return true;
}

void cholesky_solve(const double L[num_terms][num_terms], double b[num_terms]) {
  for (int i = 0; i < num_terms; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
    b[i] /= L[i][i];
  }
  for (int i = num_terms - 1; i >= 0; --i) {
    for (int k = i + 1; k < num_terms; ++k) b[i] -= L[k][i] * b[k];
    b[i] /= L[i][i];
  }
}

int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const CellStressView& stress, const Subset& stressed,
                const RecoveredField& field) {
  std::vector<int> singular(num_chunks(field.nodes.size(), grain), 0);
  parallel_chunks(
      "cgcontact::spr::fit", field.nodes.size(), grain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          const int n = field.nodes.number(static_cast<int>(row));
          const int* cells = patches.cells.data() + patches.begin[n];
          double* a = &field.values(row, 0, 0);
          if (patches.full[n]) {
            fit_full_patch(cells, stress, stressed, a);
            continue;
          }
          const Index3& node = mesh.nodes[n];
          const double centre[3] = {double(node[0]), double(node[1]), double(node[2])};
          PatchSums sums =
              gather_patch(mesh, patches, cells, patches.begin[n + 1] - patches.begin[n], centre, stress, stressed);
          singular[chunk] += !fit_patch(sums, a);
        }
      });
  int sum = 0;
  for (int count : singular) sum += count;
  return sum;
}

int recover_all(const BodyMesh& mesh, const PatchSet& patches, const RealView& u, const RecoveredField& field,
                int nodes_per_part) {
  int singular = 0;
  CellStressView buffer;
  for (int begin = 0; begin < mesh.num_nodes; begin += nodes_per_part) {
    const int end = std::min(begin + nodes_per_part, mesh.num_nodes);
    const RecoveredField part_of_field{
        Subset::range(begin, end, mesh.num_nodes),
        Kokkos::subview(field.values, std::make_pair(begin, end), Kokkos::ALL, Kokkos::ALL)};
    const Subset cells = cells_of_patches(mesh, patches, part_of_field.nodes);
    if (static_cast<int>(buffer.extent(0)) < cells.size())
      buffer =
          CellStressView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::spr::cell_stress"), cells.size());
    integrate_cell_stress(mesh, patches, cells, u, buffer);
    singular += fit_patches(mesh, patches, buffer, cells, part_of_field);
  }
  return singular;
}

}  // namespace cgcontact
