#include "recovery/spr/spr.hpp"

#include <algorithm>

#include "recovery/patch/polynomials.hpp"
#include "recovery/spr/spr_kernels.hpp"

namespace cgcontact {
namespace {

using Host = Kokkos::DefaultHostExecutionSpace;

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

void integrate_cell_stress(const BodyMesh& mesh, const PatchSet& patches, const Subset& cells, const RealView& u,
                           const CellStressView& out) {
  const Host exec;
  integrate_cells(exec, host_arrays(mesh, patches), host_arrays(cells),
                  Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u), out);
  exec.fence();
}

Subset cells_of_patches(const BodyMesh& mesh, const PatchSet& patches, const Subset& nodes) {
  std::vector<char> marked(mesh.cell_nodes.size(), 0);
  for (int row = 0; row < nodes.size(); ++row) {
    const int n = nodes.number(row);
    for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p) marked[patches.cells[p]] = 1;
  }
  return Subset(marked);
}

int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const CellStressView& stress, const Subset& stressed,
                const RecoveredField& field) {
  return fit_nodes(Host(), host_arrays(mesh, patches), host_arrays(field.nodes), stress, host_arrays(stressed),
                   field.values);
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
