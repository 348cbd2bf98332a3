#include "recovery/spr/spr.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/base/process/ranks.hpp"
#include "recovery/patch/polynomials.hpp"
#include "recovery/spr/spr_kernels.hpp"

namespace cgcontact {
namespace {

using Host = Kokkos::DefaultHostExecutionSpace;
using Quadratic = Polynomial<2>;

/// Coefficients of a polynomial in new coordinates y, where its own are x = offset + scale y.
void move_polynomial(const double from[Quadratic::num_terms], const double offset[3], double scale,
                     double to[Quadratic::num_terms]) {
  double p[Quadratic::num_terms];
  Quadratic::terms(offset, p);
  to[0] = 0;
  for (int t = 0; t < Quadratic::num_terms; ++t) to[0] += p[t] * from[t];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double slope = 2 * offset[i] * from[4 + i] + offset[j] * from[7 + i] + offset[k] * from[7 + k];
    to[1 + i] = scale * (from[1 + i] + slope);
    to[4 + i] = scale * scale * from[4 + i];
    to[7 + i] = scale * scale * from[7 + i];
  }
}

}  // namespace

RecoveredField restricted_field(const RecoveredField& field, Subset nodes) {
  RecoveredField result{std::move(nodes), {}};
  result.values =
      CoefficientView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::spr::part"), result.nodes.size());
  std::vector<int> rows, others;
  for (int row = 0; row < result.nodes.size(); ++row) {
    const int node = result.nodes.number(row);
    if (field.nodes.row(node) >= 0) {
      std::copy_n(field.at(node), 6 * num_terms, &result.values(row, 0, 0));
      continue;
    }
    rows.push_back(row);
    others.push_back(node);
  }
  if (others.empty()) return result;
  std::vector<Coefficients> made(others.size());
  field.interior->at_all(others, made.front().data());
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::copy_n(made[i].data(), 6 * num_terms, &result.values(rows[i], 0, 0));
  return result;
}

PolynomialBlock::PolynomialBlock(const BodyMesh& mesh, const RecoveredField& field, std::size_t first_cell,
                                 std::size_t end_cell)
    : field_(field) {
  if (!field.interior || first_cell == end_cell) return;
  int low = mesh.cell_nodes[first_cell][0], high = low;
  for (std::size_t c = first_cell; c < end_cell; ++c)
    for (const int corner : mesh.cell_nodes[c]) {
      low = std::min(low, corner);
      high = std::max(high, corner);
    }
  first_ = low - mesh.first_node;
  row_.assign(high - low + 1, -1);
  std::vector<int> nodes;
  for (std::size_t c = first_cell; c < end_cell; ++c)
    for (const int corner : mesh.cell_nodes[c]) {
      int& row = row_[corner - low];
      if (row >= 0 || field.nodes.row(corner - mesh.first_node) >= 0) continue;
      row = static_cast<int>(nodes.size());
      nodes.push_back(corner - mesh.first_node);
    }
  values_.resize(nodes.size());
  if (!nodes.empty()) field.interior->at_all(nodes, values_.front().data());
}

void add_edge_terms(const BodyMesh& mesh, const RecoveredField& field, int cell, const double xi[3], const double N[8],
                    double s[6]) {
  const Vec3 x = grid_position(*mesh.cut_cells, cell, Vec3(xi[0], xi[1], xi[2]));
  for (int a = 0; a < 8; ++a)
    each_master(mesh, mesh.cell_nodes[cell][a] - mesh.first_node, [&](int node, double weight) {
      const EdgeTerms::Term* term = field.edge->of_node(node);
      if (!term) return;
      double w[6];
      term->edge.stress(x, w);
      for (int k = 0; k < 6; ++k) s[k] += N[a] * weight * term->factor * w[k];
    });
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

void set_constrained_nodes(const BodyMesh& mesh, const RecoveredField& field, QuadraticTerms* quadratic) {
  const bool any_quadratic = quadratic && !quadratic->values.empty();
  for (const NodeConstraint& constraint : mesh.constraints) {
    const int node = constraint.node - mesh.first_node;
    if (field.nodes.row(node) < 0) continue;
    double mean[6][Quadratic::num_terms] = {};
    bool is_quadratic = false;
    for (const auto& [number, weight] : constraint.masters) {
      const int master = number - mesh.first_node;
      if (field.nodes.row(master) < 0) throw std::logic_error("the master of a constrained node is not in the field");
      const double unit = unit_of(mesh, master);
      const Vec3 offset = (mesh.node_position(node) - mesh.node_position(master)) / unit;
      const double* linear = field.at(master);
      const QuadraticTerms::Values* values = any_quadratic ? quadratic->of_node(master) : nullptr;
      is_quadratic = is_quadratic || values;
      for (int k = 0; k < 6; ++k) {
        double from[Quadratic::num_terms] = {}, to[Quadratic::num_terms];
        std::copy_n(linear + num_terms * k, num_terms, from);
        if (values) std::copy_n((*values)[k].data(), QuadraticTerms::count, from + num_terms);
        move_polynomial(from, offset.data(), unit_of(mesh, node) / unit, to);
        for (int t = 0; t < Quadratic::num_terms; ++t) mean[k][t] += weight * to[t];
      }
    }
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) field.values(field.nodes.row(node), k, t) = mean[k][t];
    if (!is_quadratic) continue;
    if (quadratic->row_of_node[node] < 0) {
      quadratic->row_of_node[node] = static_cast<int>(quadratic->values.size());
      quadratic->values.emplace_back();
    }
    for (int k = 0; k < 6; ++k)
      std::copy_n(mean[k] + num_terms, QuadraticTerms::count,
                  quadratic->values[quadratic->row_of_node[node]][k].data());
  }
}

int fit_patches(const BodyMesh& mesh, const PatchSet& patches, const CellStressView& stress, const Subset& stressed,
                const RecoveredField& field) {
  const int singular = fit_nodes(Host(), host_arrays(mesh, patches), host_arrays(field.nodes), stress,
                                 host_arrays(stressed), field.values);
  set_constrained_nodes(mesh, field);
  return singular;
}

int recover_all(const BodyMesh& mesh, const PatchSet& patches, const RealView& u, const RecoveredField& field,
                int nodes_per_chunk) {
  int singular = 0;
  CellStressView buffer;
  const auto [first, last] = share_out(field.nodes.size());
  for (int begin = static_cast<int>(first); begin < static_cast<int>(last); begin += nodes_per_chunk) {
    const int end = std::min(begin + nodes_per_chunk, static_cast<int>(last));
    std::vector<char> marked(mesh.num_nodes, 0);
    for (int row = begin; row < end; ++row) marked[field.nodes.number(row)] = 1;
    const RecoveredField chunk{Subset(marked),
                               Kokkos::subview(field.values, std::make_pair(begin, end), Kokkos::ALL, Kokkos::ALL)};
    const Subset cells = cells_of_patches(mesh, patches, chunk.nodes);
    if (static_cast<int>(buffer.extent(0)) < cells.size())
      buffer =
          CellStressView(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::spr::cell_stress"), cells.size());
    integrate_cell_stress(mesh, patches, cells, u, buffer);
    singular += fit_nodes(Host(), host_arrays(mesh, patches), host_arrays(chunk.nodes), buffer, host_arrays(cells),
                          chunk.values);
  }
  if (num_ranks() > 1) {
    put_together(field.values.data(), field.nodes.size(), sizeof(double) * 6 * num_terms);
    double sum = singular;
    sum_over_ranks(&sum, 1);
    singular = static_cast<int>(sum);
  }
  set_constrained_nodes(mesh, field);
  return singular;
}

}  // namespace cgcontact
